"""Missions that are run many times, by the model or by a whole system, and claims about what they did."""
