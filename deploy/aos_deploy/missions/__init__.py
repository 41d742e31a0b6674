"""Missions from start to end: one run, a system that stays, a robot that only serves."""
