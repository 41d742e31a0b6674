"""Abstraction mappings to Python: the text of the modules that workers run."""
