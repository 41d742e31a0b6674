"""Missions that are recorded, for tests that replay and study them."""
