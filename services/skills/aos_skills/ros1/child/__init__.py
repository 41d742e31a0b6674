"""The process that speaks rospy: it runs in the Python that ROS 1 is installed for, 3.8 or newer."""
