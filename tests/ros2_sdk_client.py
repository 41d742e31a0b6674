"""Somebody's ROS 2 program, written with `zenoh-ros2-sdk`: drives the robot on the spot and reads its joints.

    python -m tests.ros2_sdk_client PORT

Prints whether the drive succeeded, and the number of joint angles in the first message.
"""

import sys
import threading
from typing import Any

from zenoh_ros2_sdk import ROS2ServiceClient, ROS2Subscriber

from aos_runtime.processes.parent import die_with_parent

REQUEST = "float64 x\nfloat64 y\nfloat64 yaw\n"
RESPONSE = "bool success\nstring message\n"
PATIENCE_S = 120.0


def main() -> None:
    die_with_parent()
    router: dict[str, Any] = {"router_ip": "127.0.0.1", "router_port": int(sys.argv[1]), "domain_id": 0}
    joints: list[int] = []
    has_joints = threading.Event()

    def on_joints(message: Any) -> None:
        joints.append(len(message.positions))
        has_joints.set()

    subscriber = ROS2Subscriber(
        "/joints", "armadillo_skills/msg/Joints", on_joints, "float64[] positions\n", **router
    )
    client = ROS2ServiceClient(
        "/navigate", "armadillo_skills/srv/Navigate", REQUEST, RESPONSE, timeout=PATIENCE_S, **router
    )
    response = client.call(x=0.0, y=-2.0, yaw=-1.5708)
    has_joints.wait(PATIENCE_S)
    print(response is not None and response.success, joints[0] if joints else None, flush=True)
    client.close()
    subscriber.close()


if __name__ == "__main__":
    main()
