"""Missions whose processes are killed and frozen at random, and what became of them."""
