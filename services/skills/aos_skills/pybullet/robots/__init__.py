"""Robots, one folder each: their description and the parts that move them."""
