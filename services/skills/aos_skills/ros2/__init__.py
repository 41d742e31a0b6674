"""ROS 2 nodes that speak over Zenoh (rmw_zenoh), without ROS installed."""
