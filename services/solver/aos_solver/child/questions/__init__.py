"""The questions to an engine child."""
