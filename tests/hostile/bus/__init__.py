"""Whoever is on the bus tries all that he may not do."""
