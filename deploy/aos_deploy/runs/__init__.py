"""Runs on the disk: the folder of a run, its record, its end and verdict, and those that go on.

What starts a run stands in `missions`.
"""
