"""Adapters: what turns an activation into motion."""
