"""A robot as people write them in ROS 1: run by the system's Python, with nothing of AOS.

Serves /robot/stop (std_srvs/Trigger), which fails the second time, and the action /robot/drive
(actionlib/Test), which drives to its goal in steps of 1; publishes /robot/said (std_msgs/String) when it
starts.
"""

import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestResult
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse

STEP_S = 0.01


class Robot:
    def __init__(self):
        self.stops = 0
        rospy.init_node("robot")
        self.said = rospy.Publisher("/robot/said", String, latch=True, queue_size=1)
        self.said.publish("ready")
        rospy.Service("/robot/stop", Trigger, self.stop)
        self.server = actionlib.SimpleActionServer("/robot/drive", TestAction, self.drive, auto_start=False)
        self.server.start()

    def stop(self, _):
        self.stops += 1
        if self.stops == 2:
            raise ValueError("the brake's worn")
        return TriggerResponse(success=True, message="stands")

    def drive(self, goal):
        if goal.goal < 0:
            self.server.set_aborted(text="no reverse gear")
            return
        for way in range(goal.goal):
            if self.server.is_preempt_requested():
                self.server.set_preempted(TestResult(way))
                return
            self.server.publish_feedback(TestFeedback(way))
            rospy.sleep(STEP_S)
        self.server.set_succeeded(TestResult(goal.goal))


if __name__ == "__main__":
    Robot()
    rospy.spin()
