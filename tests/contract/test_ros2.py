import asyncio
import importlib.util
import os
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from places import DATA, ROOT
from processes import HANG_S

pytest.importorskip("rosbags", reason="needs the extra `ros`")

from aos_protocol.errors import BusError, DeployError, SkillError
from aos_runtime.processes.parent import PARENT_VARIABLE
from aos_skills.ros.node import ActionRequest, Qos, ServiceRequest
from aos_skills.ros.types import RosTypes
from aos_skills.ros2.node import Node
from aos_skills.ros2.wire import Kind

INTERFACES = DATA / "interfaces"
ADD = "example_interfaces/srv/AddTwoInts"
FIBONACCI = "example_interfaces/action/Fibonacci"
STRING = "std_msgs/msg/String"
Handler = Callable[[dict[str, Any]], Awaitable[dict[str, Any]]]


@asynccontextmanager
async def opened(endpoint: str, name: str, *interfaces: Path) -> AsyncIterator[Node]:
    types = RosTypes("jazzy", interfaces or [INTERFACES])
    async with await Node.open(endpoint, types, name=name) as node:
        yield node


@pytest_asyncio.fixture
async def robot(endpoint: str) -> AsyncIterator[Node]:
    async with opened(endpoint, "robot") as node:
        yield node


@pytest_asyncio.fixture
async def node(endpoint: str) -> AsyncIterator[Node]:
    async with opened(endpoint, "aos") as node:
        yield node


async def add(request: dict[str, Any]) -> dict[str, Any]:
    return {"sum": request["a"] + request["b"]}


async def count_up(
    goal: dict[str, Any], stop: asyncio.Event, feedback: Callable[[dict[str, Any]], None]
) -> dict[str, Any]:
    """Fibonacci's numbers; an order of 1000 is never reached, one below 0 cannot be run."""
    if goal["order"] < 0:
        raise SkillError("an order is at least 0", code="AOS502")
    sequence = [0, 1]
    while len(sequence) < goal["order"]:
        sequence.append(min(sequence[-1] + sequence[-2], 2**31 - 1))
        feedback({"sequence": sequence})
        if goal["order"] == 1000:
            await stop.wait()
        if stop.is_set():
            break
    return {"sequence": sequence}


async def test_a_service_that_nobody_serves_is_an_error_that_lists_those_there(robot: Node, node: Node):
    robot.serve("/lab/add", ADD, add)
    await node.service_type("/lab/add", ADD, HANG_S)
    with pytest.raises(SkillError, match=r"no ROS 2 node serves /lab/sub .*/lab/add") as raised:
        await node.call(ServiceRequest("/lab/sub", {}, timeout_s=HANG_S, discovery_s=0.05))
    assert raised.value.code == "AOS505"


async def test_a_service_of_another_type_than_given_is_an_error(robot: Node, node: Node):
    robot.serve("/lab/add", ADD, add)
    with pytest.raises(SkillError, match=f"/lab/add is of type {ADD}, not std_srvs/srv/Trigger"):
        await node.call(ServiceRequest("/lab/add", {}, type_name="std_srvs/srv/Trigger", timeout_s=HANG_S))


async def test_a_type_that_is_defined_differently_there_is_an_error_and_not_silence(
    endpoint: str, node: Node, tmp_path
):
    folder = tmp_path / "example_interfaces" / "srv"
    folder.mkdir(parents=True)
    (folder / "AddTwoInts.srv").write_text("int32 a\nint32 b\n---\nint64 sum\n")
    async with opened(endpoint, "other", tmp_path) as other:
        other.serve("/lab/add", ADD, add)
        with pytest.raises(SkillError, match=r"the node other defines .*AddTwoInts .*differently") as raised:
            await node.call(ServiceRequest("/lab/add", {"a": 1, "b": 2}, timeout_s=HANG_S))
    assert raised.value.code == "AOS509"


async def test_a_type_that_is_not_known_here_names_the_file_to_add(endpoint: str, robot: Node, tmp_path):
    robot.serve("/lab/add", ADD, add)
    async with opened(endpoint, "ignorant", tmp_path) as ignorant:
        with pytest.raises(DeployError, match=r"example_interfaces/srv/AddTwoInts\.srv"):
            await ignorant.call(ServiceRequest("/lab/add", {"a": 1, "b": 2}, timeout_s=HANG_S))


async def test_a_service_that_does_not_answer_is_over_in_time(robot: Node, node: Node):
    async def never(_: dict[str, Any]) -> dict[str, Any]:
        await asyncio.Event().wait()
        return {}

    robot.serve("/lab/add", ADD, never)
    with pytest.raises(SkillError, match=r"/lab/add did not answer within 0\.2 s") as raised:
        await node.call(ServiceRequest("/lab/add", {"a": 1, "b": 2}, timeout_s=0.2))
    assert raised.value.code == "AOS503"


async def test_humble_has_no_hashes_and_is_understood(endpoint: str, node: Node):
    async with await Node.open(endpoint, RosTypes("humble", [INTERFACES]), name="old") as old:
        old.serve("/lab/add", ADD, add)
        assert (await node._server("/lab/add", ADD, HANG_S)).key.endswith("/TypeHashNotSupported")
        assert await node.call(ServiceRequest("/lab/add", {"a": 1, "b": 2}, timeout_s=HANG_S)) == {"sum": 3}


async def test_messages_arrive_and_late_comers_get_what_was_latched(robot: Node, node: Node):
    latched = Qos(depth=1, is_transient_local=True)
    received: asyncio.Queue[Any] = asyncio.Queue()
    publish = robot.publisher("/lab/map", STRING, latched)
    publish({"data": "old"})
    publish({"data": "new"})
    node.subscribe("/lab/map", STRING, received.put_nowait, latched)
    async with asyncio.timeout(HANG_S):
        # What is on its way while somebody subscribes arrives as well.
        while (message := await received.get()) == {"data": "old"}:
            pass
        assert message == {"data": "new"}
        publish({"data": "newest"})
        # Zenoh may give what it kept more than once.
        while (message := await received.get()) == {"data": "new"}:
            pass
        assert message == {"data": "newest"}


async def test_an_action_that_is_not_done_in_time_is_cancelled_at_the_robot(robot: Node, node: Node):
    ended = asyncio.Event()

    async def wait(_: Any, stop: asyncio.Event, __: Any) -> dict[str, Any]:
        await stop.wait()
        ended.set()
        return {}

    robot.serve_action("/lab/fibonacci", FIBONACCI, wait)
    await node.service_type("/lab/fibonacci/_action/get_result", "", HANG_S)
    with pytest.raises(SkillError, match=r"did not end within 2 s and was cancelled") as raised:
        await node.run_action(ActionRequest("/lab/fibonacci", {"order": 1000}, timeout_s=2.0))
    assert raised.value.code == "AOS503"
    assert ended.is_set()


def serve_goals(robot: Node, send_goal: Handler, get_result: Handler):
    robot.publisher("/lab/fibonacci/_action/feedback", f"{FIBONACCI}_FeedbackMessage")
    robot.serve("/lab/fibonacci/_action/send_goal", f"{FIBONACCI}_SendGoal", send_goal)
    robot.serve("/lab/fibonacci/_action/get_result", f"{FIBONACCI}_GetResult", get_result)


async def test_nobody_knows_what_a_goal_did_that_the_node_has_forgotten(robot: Node, node: Node):
    async def answer(_: dict[str, Any]) -> dict[str, Any]:
        return next(answers)

    answers = iter([{"accepted": True}, {"status": 0}])
    serve_goals(robot, answer, answer)
    with pytest.raises(SkillError, match="does not know the goal") as raised:
        await node.run_action(ActionRequest("/lab/fibonacci", {"order": 6}, timeout_s=HANG_S))
    assert raised.value.code == "AOS504"


async def test_a_goal_that_was_given_up_before_it_was_accepted_may_move_the_robot(robot: Node, node: Node):
    async def never(_: dict[str, Any]) -> dict[str, Any]:
        was_asked.set()
        return await asyncio.Future()

    was_asked = asyncio.Event()
    serve_goals(robot, never, never)
    goal = ActionRequest("/lab/fibonacci", {"order": 6}, timeout_s=HANG_S)
    running = asyncio.create_task(node.run_action(goal))
    async with asyncio.timeout(HANG_S):
        await was_asked.wait()
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)
    assert node.unended.actions == ["/lab/fibonacci"]


async def test_an_action_that_fails_is_aborted_and_the_log_says_why(robot: Node, node: Node, caplog):
    robot.serve_action("/lab/fibonacci", FIBONACCI, count_up)
    end = await node.run_action(ActionRequest("/lab/fibonacci", {"order": -1}, timeout_s=HANG_S))
    assert end.status == "aborted"
    assert "a goal of /lab/fibonacci is aborted: " in caplog.text


async def test_a_robot_that_leaves_in_the_middle_is_noticed_at_once(endpoint: str, node: Node):
    async with opened(endpoint, "leaving") as leaving:
        leaving.serve_action("/lab/fibonacci", FIBONACCI, count_up)
        started = asyncio.Event()
        running = asyncio.create_task(
            node.run_action(
                ActionRequest(
                    "/lab/fibonacci", {"order": 1000}, timeout_s=HANG_S, on_feedback=lambda _: started.set()
                )
            )
        )
        await started.wait()
    with pytest.raises(SkillError, match=r"serves /lab/fibonacci.* (has left|was lost)") as raised:
        await running
    assert raised.value.code == "AOS504"


async def test_a_router_that_is_not_there_is_an_error_that_says_how_to_start_it():
    with pytest.raises(BusError, match=r"no Zenoh router answers .*rmw_zenohd"):
        await Node.open("tcp/127.0.0.1:1", RosTypes(), name="aos", connect_timeout_s=0.1)


async def answered(node: Node, service: str, fields: dict[str, Any]) -> dict[str, Any]:
    """Returns the service's answer once it answers: the peer shows its token before it can."""
    async with asyncio.timeout(HANG_S):
        while True:
            try:
                return await node.call(ServiceRequest(service, fields, timeout_s=HANG_S, discovery_s=HANG_S))
            except SkillError as error:
                if error.code != "AOS504":
                    raise


@pytest.mark.skipif(
    importlib.util.find_spec("zenoh_ros2_sdk") is None, reason="needs the package zenoh-ros2-sdk"
)
async def test_an_independent_implementation_understands_us_and_we_it(endpoint: str, robot: Node, tmp_path):
    robot.serve("/aos/add_two_ints", ADD, add)
    received: asyncio.Queue[dict[str, Any]] = asyncio.Queue()
    robot.subscribe("/from_sdk", STRING, received.put_nowait)
    publish = robot.publisher("/to_sdk", STRING)
    with (tmp_path / "peer.log").open("wb") as log:
        peer = await asyncio.create_subprocess_exec(
            sys.executable,
            *("-m", "tests.ros2_sdk_peer", endpoint.rpartition(":")[2]),
            cwd=ROOT,
            env={**os.environ, PARENT_VARIABLE: str(os.getpid())},
            stdout=log,
            stderr=log,
        )
        try:
            assert await answered(robot, "/sdk/add_two_ints", {"a": 20, "b": 22}) == {"sum": 42}
            assert await robot.graph.wait_for(Kind.SUBSCRIPTION, "/to_sdk", HANG_S)
            async with asyncio.timeout(HANG_S):
                publish({"data": "loud"})
                assert await received.get() == {"data": "LOUD"}
                publish({"data": "call 1 2"})
                assert await received.get() == {"data": "3"}
        finally:
            peer.kill()
            await peer.wait()
