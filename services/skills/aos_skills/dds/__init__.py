"""ROS 2 nodes that speak DDS: robots that run Cyclone DDS or Fast DDS."""
