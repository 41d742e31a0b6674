"""Robots that run ROS 1, through the rospy of the system's own Python."""
