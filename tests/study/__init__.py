"""Missions that are recorded, replayed and studied, and the figures of that: `python -m tests.study`."""
