"""The middleware: from an activation to an observation.

It emits an abstraction mapping as Python, which a worker process runs, and calls the skill. Not in here is
how the robot moves: that is an adapter's.
"""
