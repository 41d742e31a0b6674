"""Abstraction mappings to Python, run in a worker: from an activation to an observation."""
