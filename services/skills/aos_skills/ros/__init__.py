"""The common parts of ROS 1, ROS 2 over Zenoh and ROS 2 over DDS: interface definitions, types and values."""
