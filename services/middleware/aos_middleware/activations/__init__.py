"""Activations: one skill from its parameters to the observation, and the ledger of those that ended."""
