"""Adapters: from a call of a skill to motion, in pybullet, ROS 1, ROS 2, DDS or Python functions.

Not in here is how an adapter speaks on the bus: that is `aos_runtime.adapters`.
"""
