"""The answers of an engine child, as typed data."""
