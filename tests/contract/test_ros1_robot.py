import asyncio
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from processes import HANG_S
from ros1_core import PYTHON, skip_without_ros1

from aos_protocol.errors import AosError, BusError, SkillError
from aos_runtime.processes.children import Child, guarded
from aos_skills.ros.node import ActionRequest, Qos, ServiceRequest
from aos_skills.ros1.node import Ros1Node

pytestmark = pytest.mark.slow

ROBOT = Path(__file__).resolve().parents[1] / "ros1_robot.py"
WITHOUT_ROS = ROBOT.parent / "data" / "python_without_ros.sh"
INTERFACES = ROBOT.parent / "data" / "interfaces"
CUP = {"name": "mug", "state": 1, "rim": [], "size": [1.0, 2.0, 4.0], "handles": [True]}
TEST = "actionlib/action/Test"


@pytest_asyncio.fixture
async def robot(master: str, tmp_path) -> AsyncIterator[Child]:
    """The robot's process; whoever asks for its services waits for them."""
    environment = {
        "ROS_MASTER_URI": master,
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(tmp_path),
        "PYTHONPATH": "",
    }
    with (tmp_path / "robot.log").open("wb") as log:
        robot = await Child.start(guarded([PYTHON, str(ROBOT)]), env=environment, stdout=log, stderr=log)
    try:
        yield robot
    finally:
        await robot.stop()


@pytest_asyncio.fixture
async def node(master: str) -> AsyncIterator[Ros1Node]:
    async with await Ros1Node.open(master, name="aos") as node:
        yield node


async def test_services_answer_and_their_errors_are_told(robot: Child, node: Ros1Node):
    stop = {"success": True, "message": "stands"}
    assert await node.call(ServiceRequest("/robot/stop", {}, timeout_s=HANG_S, discovery_s=HANG_S)) == stop
    with pytest.raises(SkillError, match="failed: error processing request: the brake's worn") as raised:
        await node.call(ServiceRequest("/robot/stop", {}, timeout_s=HANG_S))
    assert raised.value.code == "AOS510"
    with pytest.raises(SkillError, match="is of type std_srvs/Trigger, not std_srvs/SetBool"):
        await node.call(ServiceRequest("/robot/stop", {}, type_name="std_srvs/srv/SetBool", timeout_s=HANG_S))
    with pytest.raises(SkillError, match="std_srvs/TriggerRequest has no field speed"):
        await node.call(ServiceRequest("/robot/stop", {"speed": 1}, timeout_s=HANG_S))


async def test_actions_give_feedback_end_fail_and_are_cancelled(robot: Child, node: Ros1Node):
    await until(node, "/robot/drive", "action")
    feedback: list[Any] = []
    end = await node.run_action(
        ActionRequest("/robot/drive", {"goal": 5}, timeout_s=HANG_S, on_feedback=feedback.append)
    )
    assert end[:2] == ("succeeded", {"result": 5})
    assert {"feedback": 4} in feedback
    end = await node.run_action(ActionRequest("/robot/drive", {"goal": -1}, timeout_s=HANG_S))
    assert (end.status, end.text) == ("aborted", "no reverse gear")
    cancelled = asyncio.Event()
    end = await node.run_action(
        ActionRequest(
            "/robot/drive",
            {"goal": 10_000},
            timeout_s=HANG_S,
            cancelled=cancelled,
            on_feedback=lambda _: cancelled.set(),
        )
    )
    assert end.status == "canceled"
    assert end.result["result"] < 10_000


async def test_topics_are_found_by_name_and_latched_messages_come(robot: Child, node: Ros1Node):
    found = await node.topic("/robot/said", HANG_S)
    assert found is not None
    assert found.type_name == "std_msgs/String"
    said: asyncio.Queue[Any] = asyncio.Queue()
    node.subscribe("/robot/said", found.type_name, said.put_nowait)
    assert await asyncio.wait_for(said.get(), HANG_S) == {"data": "ready"}


@pytest.fixture
def kept_empty(tmp_path, monkeypatch) -> Iterator[None]:
    """Holds that the folder for temporary files is empty after the test."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    yield
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("kept_empty")
async def test_messages_of_own_interfaces_leave_no_files_behind(master: str):
    seen: asyncio.Queue[Any] = asyncio.Queue()
    async with await Ros1Node.open(master, name="aos", interfaces=[INTERFACES]) as node:
        node.subscribe("/cup", "lab_msgs/msg/Cup", seen.put_nowait)
        node.publisher("/cup", "lab_msgs/msg/Cup", Qos(is_transient_local=True))(CUP)
        assert await asyncio.wait_for(seen.get(), HANG_S) == CUP


async def call_for_ever(node: Ros1Node, service: str):
    while True:
        await node.call(ServiceRequest(service, {}, timeout_s=HANG_S))


async def test_a_robot_that_is_killed_in_the_middle_is_noticed(robot: Child, node: Ros1Node):
    await until(node, "/robot/drive", "action")
    started = asyncio.Event()
    driving = asyncio.create_task(
        node.run_action(
            ActionRequest(
                "/robot/drive", {"goal": 10_000}, timeout_s=60.0, on_feedback=lambda _: started.set()
            )
        )
    )
    await started.wait()
    robot.kill()
    with pytest.raises(SkillError, match=r"cannot be reached|was lost"):
        await call_for_ever(node, "/robot/get_loggers")
    assert not node.kind_of("/robot/drive"), "nobody decides for its skills once the call has failed"
    async with asyncio.timeout(HANG_S):
        # actionlib itself would wait for its end for ever.
        with pytest.raises(SkillError, match="has left while it ran") as raised:
            await driving
    assert raised.value.code == "AOS504"


async def test_of_whatever_answers_in_place_of_a_master_little_is_told():
    skip_without_ros1()

    async def answer(_: asyncio.StreamReader, writer: asyncio.StreamWriter):
        writer.write(b"noise " * 1000 + b"\n")
        await writer.drain()
        writer.close()

    async with await asyncio.start_server(answer, "127.0.0.1", 0) as server:
        host, port = server.sockets[0].getsockname()
        with pytest.raises(BusError, match=r"no ROS master answers") as raised:
            await Ros1Node.open(f"http://{host}:{port}", name="aos")
    assert len(raised.value.message) < 300


async def test_without_a_master_or_rospy_it_is_said_what_to_do(master: str):
    with pytest.raises(
        BusError, match=r"no ROS master answers at http://127\.0\.0\.1:1: .*roscore"
    ) as raised:
        await Ros1Node.open("http://127.0.0.1:1", name="aos")
    assert raised.value.code == "AOS605"
    with pytest.raises(AosError, match=r"cannot import ROS 1: .*python3-rospy") as missing:
        await Ros1Node.open(master, name="aos", python=str(WITHOUT_ROS))
    assert missing.value.code == "AOS805"


async def until(node: Ros1Node, name: str, kind: str):
    async with asyncio.timeout(HANG_S):
        while node.kind_of(name) != kind:
            await node.changed()
