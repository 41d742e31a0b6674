"""`aos bench`: what the planner is worth, in figures that one run measures."""
