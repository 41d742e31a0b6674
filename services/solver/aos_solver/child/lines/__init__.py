"""The lines that an engine child reads."""
