"""The records of a mission: its journal, what is folded out of it, and what is told."""
