"""The processes of a system: which there are, how each starts, when it is ready, and what its end means."""
