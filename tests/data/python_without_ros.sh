#!/bin/sh
# A Python for which ROS 1 is not installed, wherever the tests run.
shift
exec /usr/bin/python3 -c "import sys; sys.modules['rospy'] = None; $1" "$2"
