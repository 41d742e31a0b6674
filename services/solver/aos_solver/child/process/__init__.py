"""The process of an engine child: its start, its confinement, the memory that is shared with it."""
