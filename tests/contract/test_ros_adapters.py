"""The adapters `ros2`, `dds` and `ros1` as processes, with a robot that is a node of ours in this process.

For ROS 1 the master is a real one, and the node a real rospy process.
"""

import asyncio
import importlib.util
import itertools
import random
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio
from adapter_process import AdapterProcess
from places import DATA
from processes import HANG_S
from projects import text_project

pytest.importorskip("rosbags", reason="needs the extra `ros`")


from aos_protocol.errors import AosError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    ActivationId,
    Cancel,
    Cancelled,
    ProjectQuery,
    ProjectRevision,
    SkillCall,
    SkillProgress,
    SkillResult,
    TopicMessage,
)
from aos_runtime.adapters import Binding
from aos_runtime.bus.bus import Bus
from aos_skills.ros.node import RosNode
from aos_skills.ros.types import RosTypes

pytestmark = pytest.mark.slow

INTERFACES = DATA / "interfaces"
FIBONACCI = "example_interfaces/action/Fibonacci"

DOCUMENTS = {
    "lab.ef": """project: lab
horizon: 5
discount: 0.9
state_variable: bool done
code:
state.done = false;
initial_belief:
code:
state.done = AOS.Bernoulli(0.5);
""",
    "count.sd": """project: lab
dynamic_model:
code:
__moduleResponse = AOS.Bernoulli(0.9) ? eDone : eFailed;
""",
    "count.am": """project: lab
module_activation: ros_service
path: /lab/add
srv: AddTwoInts
imports: from: example_interfaces.srv import: *
parameter: a
code: 20
parameter: b
code: 22
local_variable: heard
type: string
topic: /lab/said
message_type: String
imports: from: std_msgs.msg import: String
initial_value: ''
code:
return __input.data
response: eDone
response_rule: heard == 'done'
response: eFailed
response_rule: True
""",
}


class Lab(AdapterProcess):
    """An adapter's process and the robot behind it."""

    def __init__(self, bus: Bus, keys: Keys, endpoint: str, folder: Path, robot: RosNode):
        super().__init__(bus, keys, endpoint, folder)
        self.robot = robot

    async def start(self, adapter: str, options: dict[str, Any], **settings: Any):
        folder = str(INTERFACES.parent)
        await self.launched(
            "robot", folder=folder, project="lab", adapter=adapter, options=options, **settings
        )

    async def until_served(self, path: str):
        async with asyncio.timeout(HANG_S), self.bus.presence(self.keys.all_serve) as present:
            async for key, is_alive in present:
                if key.endswith(path) and is_alive:
                    return

    async def until_lacked(self, path: str, reason: str) -> str:
        async with asyncio.timeout(HANG_S), self.bus.presence(self.keys.all_lacks) as present:
            async for key, is_there in present:
                lack = self.keys.lack_of(key)
                if is_there and lack is not None and lack.path == path and reason in lack.reason:
                    return lack.reason
        raise AssertionError

    async def call(self, path: str, fields: dict[str, Any], step: int, limit_s: float = 10.0) -> SkillResult:
        return await self.ask(SkillCall(ActivationId("m", step), path, fields, limit_s))


KINDS = {
    "ros2": ("aos_skills.ros.adapter:Ros2Adapter", "router"),
    "dds": ("aos_skills.ros.adapter:DdsAdapter", "interface"),
    "ros1": ("aos_skills.ros.adapter:Ros1Adapter", "master"),
}


async def robot_of(kind: str, request: pytest.FixtureRequest, endpoint: str) -> tuple[Any, dict[str, Any]]:
    types = RosTypes("jazzy", [INTERFACES])
    robot: Any
    if kind == "ros2":
        from aos_skills.ros2.node import Node

        # The robot's router is that of AOS here: they do not get into each other's way.
        robot, options = await Node.open(endpoint, types, name="robot"), {"router": endpoint}
    elif kind == "ros1":
        from aos_skills.ros1.node import Ros1Node

        options = {"master": request.getfixturevalue("master")}
        robot = await Ros1Node.open(options["master"], name="robot", interfaces=[INTERFACES])
    else:
        if importlib.util.find_spec("cyclonedds") is None:
            pytest.skip("needs the extra `dds`")
        from aos_skills.dds.node import DdsNode

        domain = random.SystemRandom().randint(1, 100)
        robot, options = DdsNode(types, domain=domain), {"domain": domain}
    robot.serve("/lab/add", "example_interfaces/srv/AddTwoInts", add)
    robot.serve_action("/lab/count", FIBONACCI, count_up)
    return robot, options


@pytest_asyncio.fixture(params=KINDS)
async def lab(request, bus: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[Lab]:
    robot, options = await robot_of(request.param, request, endpoint)
    lab = Lab(bus, keys, endpoint, tmp_path, robot)
    await lab.start(
        KINDS[request.param][0],
        options | {"interfaces": ["interfaces"]},
        bind={
            "/sum": Binding(target="/lab/add", result={"total": "sum"}),
            "/count": Binding(target={"action": "/lab/count", "type": FIBONACCI}),
            "/wave": Binding(target="/lab/wave"),
        },
        serves_others=True,
    )
    try:
        yield lab
    finally:
        await lab.stop()
        await robot.close()


async def add(request: dict[str, Any]) -> dict[str, Any]:
    return {"sum": request["a"] + request["b"]}


async def count_up(
    goal: dict[str, Any], stop: asyncio.Event, feedback: Callable[[dict[str, Any]], None]
) -> dict[str, Any]:
    """Counts to the order; one of 1000 it only starts, and says so until it is stopped."""
    sequence = list(range(min(goal["order"], 3)))
    feedback({"sequence": sequence})
    while goal["order"] == 1000 and not stop.is_set():
        with suppress(TimeoutError):
            await asyncio.wait_for(stop.wait(), 0.1)
            break
        feedback({"sequence": sequence})
    return {"sequence": sequence}


async def test_services_and_actions_of_the_robot_are_skills(lab: Lab):
    await lab.until_served("/sum")
    assert (await lab.call("/sum", {"a": 20, "b": 22}, 1)).fields == {"total": 42}
    await lab.until_served("/count")
    topic = lab.keys.topic("/count/feedback")
    async with asyncio.timeout(HANG_S), lab.bus.listen(topic, TopicMessage) as feedback:
        # A ROS 1 server loses what it says before it knows the one who listens.
        for step in itertools.count(10):
            result = await lab.call("/count", {"order": 3}, step)
            if result.published:
                break
        assert (await anext(aiter(feedback)))[1].fields == {"sequence": [0, 1, 2]}
    assert result.fields == {"sequence": [0, 1, 2]}
    assert result.published == {"/count/feedback": 1}
    log = (lab.folder / "robot.log").read_text()
    assert "no node serves /lab/wave; served are /lab/add, /lab/count" in log
    with pytest.raises(AosError, match=r"AddTwoInts_?Request has no field c") as raised:
        await lab.call("/sum", {"c": 1}, 3)
    assert raised.value.code == "AOS502"


async def test_an_action_is_cancelled_at_the_robot_and_late_ones_too(lab: Lab):
    await lab.until_served("/count")
    async with lab.bus.listen(lab.keys.progress("/count"), SkillProgress) as progress:
        running = asyncio.create_task(lab.call("/count", {"order": 1000}, 1, limit_s=HANG_S))
        async with asyncio.timeout(HANG_S):
            async for _, state in progress:
                if state.state == "executing" and state.text:
                    assert state.text == '{"sequence": [0, 1, 2]}'
                    break
        assert (await lab.cancel("/count")).ids == ("m-1",)
        with pytest.raises(AosError) as raised:
            await running
        assert raised.value.code == "AOS507"
    with pytest.raises(AosError) as raised:
        await lab.call("/count", {"order": 1000}, 2, limit_s=1.5)
    assert raised.value.code == "AOS503"
    assert (await lab.call("/count", {"order": 1}, 3, limit_s=HANG_S)).fields == {"sequence": [0]}


async def test_a_goal_that_does_not_end_when_it_is_cancelled_counts_as_moving_until_it_ends(lab: Lab):
    is_still = asyncio.Event()

    async def deaf(
        _: dict[str, Any], __: asyncio.Event, ___: Callable[[dict[str, Any]], None]
    ) -> dict[str, Any]:
        await is_still.wait()
        return {"sequence": []}

    lab.robot.serve_action("/lab/wave", FIBONACCI, deaf)
    await lab.until_served("/wave")
    running = asyncio.create_task(lab.call("/wave", {"order": 1}, 1, limit_s=1.0))
    question = Cancel("another skill is to run", ActivationId("m", 1))
    async with lab.bus.listen(lab.keys.progress("/wave"), SkillProgress) as progress:
        async with asyncio.timeout(HANG_S):
            async for _, state in progress:
                if state.state == "cancelling":
                    break
    for _ in range(2):  # While its call ends, and after that.
        with pytest.raises(AosError, match="/lab/wave has not ended"):
            await lab.bus.ask(lab.keys.cancel("/wave"), question, Cancelled, timeout_s=HANG_S)
    with pytest.raises(AosError, match="The robot may still move") as raised:
        await running
    assert raised.value.code == "AOS504"
    is_still.set()
    async with asyncio.timeout(HANG_S):
        while True:
            with suppress(SkillError):
                await lab.bus.ask(lab.keys.cancel("/wave"), question, Cancelled, timeout_s=HANG_S)
                return


async def test_documents_name_the_paths_and_topics(lab: Lab):
    revision = ProjectRevision(1, "digest", text_project(DOCUMENTS))

    async def documents(_: ProjectQuery, __: str) -> ProjectRevision:
        return revision

    publish = lab.robot.publisher("/lab/said", "std_msgs/msg/String")
    await lab.bus.answer(lab.keys.project, ProjectQuery, documents)
    lab.bus.tell(lab.keys.announced, revision)
    await lab.until_served("/lab/add")
    async with asyncio.timeout(HANG_S), lab.bus.listen(lab.keys.topic("/lab/said"), TopicMessage) as said:
        # The adapter finds the publisher by itself, and what is said before that is lost.
        while not said.has_items:
            publish({"data": "done"})
            await asyncio.sleep(0.01)
        assert (await anext(aiter(said)))[1].fields == {"data": "done"}
    result = await lab.call("/lab/add", {"a": 1, "b": 2}, 1)
    assert result.fields == {"sum": 3}
    assert result.published["/lab/said"] >= 1


@pytest.mark.parametrize("kind", ["ros2", "ros1"])  # What a node of ROS 2 is asked is one function.
@pytest.mark.parametrize("path", ["/lab/add", "/lab/count"])
async def test_an_interface_that_is_not_known_ends_the_adapter_with_the_file_to_add(
    kind, path, request, bus: Bus, keys: Keys, endpoint: str, tmp_path
):
    robot, options = await robot_of(kind, request, endpoint)
    lab = Lab(bus, keys, endpoint, tmp_path, robot)
    try:
        await lab.start(KINDS[kind][0], options, bind={path: Binding()})
        assert lab.child is not None
        assert await asyncio.wait_for(lab.child.wait(), HANG_S) != 0
    finally:
        await robot.close()
        await lab.stop()
    log = (tmp_path / "robot.log").read_text()
    file = "srv/AddTwoInts.srv" if path == "/lab/add" else "action/Fibonacci.action"
    assert "AOS806" in log
    assert f"Add the file example_interfaces/{file}" in log


async def test_a_node_that_never_answers_does_not_hold_a_cancellation_up(
    request, bus: Bus, keys: Keys, endpoint: str, tmp_path
):
    robot, options = await robot_of("ros2", request, endpoint)
    lab = Lab(bus, keys, endpoint, tmp_path, robot)
    asked = asyncio.Event()

    async def never(_: dict[str, Any]) -> dict[str, Any]:
        asked.set()
        await asyncio.Event().wait()
        return {}

    robot.serve("/lab/mute/_action/send_goal", f"{FIBONACCI}_SendGoal", never)
    options["interfaces"] = ["interfaces"]
    try:
        await lab.start(KINDS["ros2"][0], options, bind={"/lab/mute": Binding()})
        await lab.until_served("/lab/mute")
        running = asyncio.create_task(lab.call("/lab/mute", {"order": 1}, 1))
        await asyncio.wait_for(asked.wait(), HANG_S)
        await lab.cancel("/lab/mute")
        with pytest.raises(AosError, match="was to be cancelled, and its node does not answer") as raised:
            await running
        assert raised.value.code == "AOS504"
    finally:
        await lab.stop()
        await robot.close()


async def test_a_robot_that_leaves_is_withdrawn_and_why_a_path_is_not_served_is_told(lab: Lab):
    none = await lab.until_lacked("/wave", "/lab/add, /lab/count")
    assert none == "no node serves /lab/wave; served are /lab/add, /lab/count"
    async with asyncio.timeout(HANG_S), lab.bus.presence(lab.keys.all_serve) as present:
        async for key, is_alive in present:
            if key.endswith("/sum"):
                if not is_alive:
                    break
                await lab.robot.close()
    assert await lab.until_lacked("/sum", "look whether it runs, and at its log")
