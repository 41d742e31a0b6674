"""A ROS 2 node by others: `zenoh-ros2-sdk`, which was written independently of AOS.

    python -m tests.ros2_sdk_peer PORT

Serves /sdk/add_two_ints. What is published on /to_sdk comes back on /from_sdk in capitals; the text
`call A B` has it call /aos/add_two_ints and publish the sum.
"""

import sys
import threading
from typing import Any

from zenoh_ros2_sdk import ROS2Publisher, ROS2ServiceClient, ROS2ServiceServer, ROS2Subscriber

from aos_runtime.processes.parent import die_with_parent

ADD = {"request_definition": "int64 a\nint64 b\n", "response_definition": "int64 sum\n"}
STRING = "string data\n"


def main() -> None:
    """Runs until it is ended."""
    die_with_parent()
    router: dict[str, Any] = {"router_ip": "127.0.0.1", "router_port": int(sys.argv[1]), "domain_id": 0}
    out = ROS2Publisher("/from_sdk", "std_msgs/msg/String", STRING, **router)

    def call(a: int, b: int) -> None:
        client = ROS2ServiceClient("/aos/add_two_ints", "example_interfaces/srv/AddTwoInts", **ADD, **router)
        response = client.call(a=a, b=b)
        out.publish(data="no response" if response is None else str(response.sum))

    def on_message(message: Any) -> None:
        word, *numbers = message.data.split()
        if word == "call":
            # Subscribers are called on Zenoh's thread, which has to stay free for the answer.
            threading.Thread(target=call, args=[int(number) for number in numbers]).start()
        else:
            out.publish(data=message.data.upper())

    ROS2Subscriber("/to_sdk", "std_msgs/msg/String", on_message, STRING, **router)

    def add(request: Any) -> Any:
        return server.response_msg_class(sum=request.a + request.b)

    server = ROS2ServiceServer("/sdk/add_two_ints", "example_interfaces/srv/AddTwoInts", add, **ADD, **router)
    threading.Event().wait()


if __name__ == "__main__":
    main()
