"""The parts of a project that are at work: mappings of its revisions, monitors, low-level values."""
