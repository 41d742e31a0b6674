"""What ROS 1, ROS 2 over Zenoh and ROS 2 over DDS share: interface definitions, their types and values."""
