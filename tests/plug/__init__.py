"""Figures about what changes and what happens while a mission runs: `make plug`."""
