"""The decision for a next step."""
