"""Processes of a system: their lives and settings, their children, and the end of both with their parent."""
