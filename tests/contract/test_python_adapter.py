import asyncio
import os
from collections.abc import AsyncIterator
from typing import Any

import pytest
import pytest_asyncio
from adapter_process import AdapterProcess
from places import ROOT
from processes import HANG_S

from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import ActivationId, SkillCall, SkillProgress, SkillResult, TopicMessage
from aos_runtime.adapters import Binding
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child

ROBOT = """
import asyncio, time
from enum import Enum
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from aos_protocol.errors import SkillError
from aos_runtime.adapters import Observed

Side = Enum("Side", {"LEFT": "left"})

async def drive(call, x, y=0.0):
    call.progress(0.5, "to \\udcff")
    call.publish("/pose", x=x, y=y)
    return {"success": True}

async def wait(call):
    call.progress(0.1, "waiting")
    await asyncio.Event().wait()

def block(call):
    while not call.is_cancelled:
        time.sleep(0.01)

def wait_for_pipe(call, name):
    call.publish("/moving")
    Path(name).read_bytes()  # Until somebody has written.
    return {"motion": id(call)}

async def hang(call):
    call.progress(0.1, "hanging")
    time.sleep(1000)

async def fail(call):
    raise RuntimeError("gripper jammed")

async def names_a_file(call):
    raise RuntimeError("no \\udcff.png")

class Mute(Exception):
    def __str__(self):
        raise KeyError("text")

async def cannot_say(call):
    raise Mute

async def loses_a_part(call):
    part = asyncio.create_task(asyncio.Event().wait())
    part.cancel()
    await part

async def odd(call):
    return 3

async def measure(call):
    call.progress(np.float32(0.5), "half way")
    call.publish("/scan", ranges=np.arange(3.0), is_near=np.bool_(True))
    return {
        "depth": np.float32(0.5), "count": np.int64(3), "cells": np.eye(2, dtype=int), "side": Side.LEFT,
        "pose": SimpleNamespace(x=np.float64(1.5)), "seen": {"cup", }, "sure": np.bool_(True),
    }

async def unsendable(call):
    return {"ok": True, "picture": iter([])}

async def huge(call):
    return {"picture": bytes(17_000_000)}

async def too_far(call):
    return {"ticks": 2 ** 70}

async def says_too_much(call):
    call.publish("/scan", made_by=measure)

async def says_it_to_none(call):
    call.publish(None, x=1)

async def says_it_aside(call):
    call.publish("pose of arm", x=1)

async def nonsense(call):
    return Observed(3)

async def lose():
    raise SkillError("the arm is lost", code="AOS504")

async def grouped(call):
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(lose())

decorated = lambda call: grouped(call)

async def wordless(call):
    return Observed("done", {}, {"camera": 3})

async def numberless(call):
    return Observed("done", None)

def leave(call):
    raise SystemExit(4)

async def leave_soon(call):
    raise SystemExit(4)

def look_in_vain(call):
    return {"cup": next(cup for cup in [] if cup)}

async def turn(angle):
    return {}

def sweep(call):
    yield 1


def beep():
    return {}

class Arm:
    def __init__(self):
        self.picks = 0

    async def pick(self, call):
        self.picks += 1

    async def count(self, call):
        return {"picks": self.picks}

class Near:
    def __init__(self, port="/dev/ttyUSB0"):
        self.port = port
    def reach(self, call): return {"port": self.port}

class Hosted:
    def __init__(self, host=None):
        self.host = host
    def reach(self, call): return {"name": self.host.name}
"""


class Robot(AdapterProcess):
    async def launch(self, **bound: str) -> Child:
        (self.folder / "robot.py").write_text(ROBOT)
        return await self.launched(
            "python",
            adapter="aos_skills.python_functions:PythonAdapter",
            folder=str(self.folder),
            bind={f"/{path}": Binding(target=target) for path, target in bound.items()},
            cancel_s=2.0,
        )

    async def start(self, **bound: str):
        await self.launch(**bound)
        async with asyncio.timeout(HANG_S), self.bus.presence(self.keys.all_serve) as present:
            paths: set[str] = set()
            async for key, _ in present:
                serving = self.keys.serving_of(key)
                assert serving is not None
                paths.add(serving.path)
                if len(paths) == len(bound):
                    return

    async def call(self, path: str, step: int = 1, deadline_s: float = 20.0, **fields: Any) -> SkillResult:
        return await self.ask(SkillCall(ActivationId("m", step), path, fields, deadline_s))


@pytest_asyncio.fixture
async def robot(bus: Bus, keys: Keys, endpoint: str, tmp_path) -> AsyncIterator[Robot]:
    robot = Robot(bus, keys, endpoint, tmp_path)
    try:
        yield robot
    finally:
        await robot.stop()


async def test_a_function_gets_the_fields_and_tells_progress_and_topics(robot: Robot):
    await robot.start(drive="robot.py:drive", pick="robot.py:Arm.pick", count="robot.py:Arm.count")
    progress = robot.bus.listen(robot.keys.progress("/drive"), SkillProgress)
    poses = robot.bus.listen(robot.keys.topic("/pose"), TopicMessage)
    async with asyncio.timeout(HANG_S), progress, poses:
        result = await robot.call("/drive", x=1.5)
        assert (result.fields, result.published) == ({"success": True}, {"/pose": 1})
        assert (await anext(poses))[1].fields == {"x": 1.5, "y": 0.0}
        states = [(await anext(progress))[1] for _ in range(3)]
    assert [(state.state, state.progress, state.text) for state in states] == [
        ("accepted", 0.0, ""),
        ("executing", 0.5, r"to \udcff"),
        ("succeeded", 1.0, ""),
    ]
    # Methods of a class share one object.
    assert (await robot.call("/pick", 2)).fields == {}
    assert (await robot.call("/count", 3)).fields == {"picks": 1}


async def test_a_class_is_made_with_the_host_only_where_it_asks_for_one(robot: Robot):
    await robot.start(near="robot.py:Near.reach", hosted="robot.py:Hosted.reach")
    assert (await robot.call("/near", 1)).fields == {"port": "/dev/ttyUSB0"}
    assert (await robot.call("/hosted", 2)).fields == {"name": "python"}


async def test_numpys_numbers_and_other_objects_become_plain_data(robot: Robot):
    await robot.start(measure="robot.py:measure")
    scans = robot.bus.listen(robot.keys.topic("/scan"), TopicMessage)
    async with asyncio.timeout(HANG_S), scans:
        result = await robot.call("/measure")
        assert (await anext(scans))[1].fields == {"ranges": [0.0, 1.0, 2.0], "is_near": True}
    assert result.fields == {
        "depth": 0.5, "count": 3, "cells": [[1, 0], [0, 1]], "side": "left", "pose": {"x": 1.5},
        "seen": ["cup"], "sure": True,
    }  # fmt: skip


async def test_what_goes_wrong_in_a_function_fails_that_call_alone(robot: Robot):
    wrong: list[tuple[str, dict[str, Any], str, str]] = [
        ("fail", {}, "AOS510", "/fail failed: RuntimeError: gripper jammed"),
        ("names_a_file", {}, "AOS510", "failed: RuntimeError: no \\udcff.png"),
        ("cannot_say", {}, "AOS510", "/cannot_say failed: Mute: (its text raised KeyError)"),
        ("loses_a_part", {}, "AOS510", "failed: CancelledError: what it awaits was cancelled"),
        ("leave", {}, "AOS510", "/leave failed: SystemExit: 4"),
        ("leave_soon", {}, "AOS510", "/leave_soon failed: SystemExit: 4"),
        ("look_in_vain", {}, "AOS510", "/look_in_vain failed: StopIteration"),
        ("odd", {}, "AOS504", "/odd answered 3, which is no mapping of field names to values"),
        ("unsendable", {}, "AOS504", "the field picture of the result of /unsendable cannot be sent"),
        ("huge", {}, "AOS504", "the result of /huge has 17000005 bytes, and the bus carries 16777216"),
        ("too_far", {}, "AOS504", "the field ticks of the result of /too_far cannot be sent"),
        ("says_too_much", {}, "AOS510", "the field made_by of a message on /scan cannot be sent"),
        ("says_it_to_none", {}, "AOS510", "the topic None is no text"),
        ("says_it_aside", {}, "AOS510", "no topic has such a name: 'pose of arm' is not a path"),
        ("nonsense", {}, "AOS504", "the observation of /nonsense is 3, which is no word"),
        ("grouped", {}, "AOS504", "the arm is lost"),
        ("decorated", {}, "AOS504", "the arm is lost"),
        ("wordless", {}, "AOS504", "the observation of /wordless is 3, which is no word"),
        ("numberless", {}, "AOS504", "the numbers of the observation of /numberless are None"),
        ("drive", {"z": 1}, "AOS502", "The function takes x, y; the mapping sends z"),
        ("turn", {"angle": 1}, "AOS502", "The first argument is the call, and no field: write (call, angle)"),
    ]
    await robot.start(**{each[0]: f"robot.py:{each[0]}" for each in wrong})
    for step, (function, fields, code, text) in enumerate(wrong):
        error = await robot.refusal(f"/{function}", 2 * step, **fields)
        assert error.code == code
        assert text in str(error)
        assert (await robot.call("/drive", 2 * step + 1, x=0)).fields == {"success": True}


@pytest.mark.parametrize("function", ["wait", "block"])
async def test_a_cancelled_function_ends_and_the_next_one_runs(robot: Robot, function):
    await robot.start(skill=f"robot.py:{function}", drive="robot.py:drive")
    progress = robot.bus.listen(robot.keys.progress("/skill"), SkillProgress)
    async with asyncio.timeout(HANG_S), progress:
        running = asyncio.create_task(robot.refusal("/skill", 1))
        await anext(progress)
        assert (await robot.cancel("/skill")).ids == ("m-1",)
    assert (await running).code == "AOS507"
    assert (await robot.call("/drive", 2, x=0)).fields == {"success": True}


async def test_a_call_that_comes_again_while_it_runs_joins_it_and_its_id_is_for_nothing_else(
    robot: Robot, tmp_path
):
    await robot.start(wait="robot.py:wait_for_pipe")
    pipe = tmp_path / "go on"
    os.mkfifo(pipe)
    async with robot.bus.listen(robot.keys.topic("/moving"), TopicMessage) as moving:
        first = asyncio.create_task(robot.call("/wait", 1, name=str(pipe)))
        await anext(moving)
    again = asyncio.create_task(robot.call("/wait", 1, name=str(pipe)))
    # Questions of one asker are taken in order.
    assert (await robot.refusal("/wait", 1, name="another")).code == "AOS514"
    await asyncio.to_thread(pipe.write_bytes, b"")
    assert await again == await first


async def test_what_moves_is_stopped_when_the_middleware_was_away_for_too_long(robot: Robot):
    middleware = robot.keys.live("middleware")
    await robot.bus.announce(middleware)
    await robot.start(wait="robot.py:wait", drive="robot.py:drive")
    async with robot.bus.listen(robot.keys.progress("/wait"), SkillProgress) as progress:
        running = asyncio.create_task(robot.refusal("/wait", 1))
        await anext(progress)
    robot.bus.withdraw(middleware)
    refusal = await running
    assert (refusal.code, "the middleware has gone" in str(refusal)) == ("AOS507", True)
    assert (await robot.call("/drive", 2, x=0)).fields == {"success": True}, "a call by hand needs none"


@pytest.mark.parametrize(("deadline_s", "until"), [(20.0, "executing"), (0.1, "cancelling")])
async def test_a_function_that_cannot_be_stopped_ends_the_process_and_is_unknown(
    robot: Robot, deadline_s, until
):
    await robot.start(skill="robot.py:hang")
    progress = robot.bus.listen(robot.keys.progress("/skill"), SkillProgress)
    async with asyncio.timeout(HANG_S), progress:
        running = asyncio.create_task(robot.refusal("/skill", deadline_s=deadline_s))
        async for _, state in progress:
            if state.state == until:
                break
        with pytest.raises(AosError) as error:
            await robot.cancel("/skill")
    assert error.value.code in ("AOS504", "AOS607"), "stuck, or its process has ended at once"
    assert "/skill did not stop within 2 s" in (await running).message
    assert robot.child is not None
    async with asyncio.timeout(HANG_S):
        assert await robot.child.wait() == 1
    log = (robot.folder / "python.log").read_text()
    line = ROBOT[: ROBOT.index("    time.sleep(1000)")].count("\n") + 1
    assert f"/skill is cancelled, and goes on at {robot.folder / 'robot.py'}:{line}" in log
    assert "/skill did not stop within 2 s" in log


async def test_a_shell_script_is_a_skill_by_the_function_of_the_page(robot: Robot):
    page = (ROOT / "docs/adapters/command.md").read_text(encoding="utf-8")
    function = page.partition("```python\nimport asyncio")[2].partition("```")[0]
    script = robot.folder / "take.sh"
    (robot.folder / "take.py").write_text(f"import asyncio{function}")
    script.write_text(
        "#!/bin/sh\ntrap 'kill $!; exit 1' TERM\nread -r fields\n"
        "case $fields in *never*) sleep 1000 & wait $! ;; *no*) exit 3 ;; *odd*) fields=odd ;; esac\n"
        'echo "$fields"\n'
    )
    script.chmod(0o700)
    await robot.start(take="take.py:take")
    assert (await robot.call("/take", 1, side="left")).fields == {"side": "left"}
    refusal = await robot.refusal("/take", 2, side="none")
    assert (refusal.code, "take.sh ended with 3" in refusal.message) == ("AOS510", True)
    assert (await robot.refusal("/take", 3, side="never", deadline_s=0.5)).code == "AOS503"
    refusal = await robot.refusal("/take", 5, side="odd")
    assert (refusal.code, "take.sh printed no JSON: b'odd" in refusal.message) == ("AOS504", True)
    assert (await robot.call("/take", 4, side="right")).fields == {"side": "right"}, "it runs on"


@pytest.mark.parametrize(
    ("target", "text"),
    [
        ("robot.py:fly", "robot.py has no fly. It has Side, drive, wait, block"),
        ("nowhere.py:drive", "there is no file"),
        ("drive", "/skill is not bound to a function. Write it as /skill: {python: my_robot.py:function}"),
        ("robot.py:time", "which cannot be called"),
        ("robot.py:beep", "takes no arguments. A function gets the call first"),
        ("robot.py:sweep", "which has a `yield`. A call would run nothing of it"),
        (
            "script.py:go",
            "script.py, which cannot be loaded: SystemExit: 3. What it does as a program stands",
        ),
        ("camera.py:go", "cannot be loaded: OSError: no camera. It was raised at camera.py:2"),
        ("far.py:Far.reach", "'port' and 'speed'. It is made without arguments, or with the host alone"),
        ("far.py:Lost.reach", "cannot be made: OSError: no arm. It was raised at far.py:4"),
    ],
)
async def test_what_cannot_be_bound_ends_the_process_with_one_message(robot: Robot, target, text):
    (robot.folder / "script.py").write_text("raise SystemExit(3)\n")
    (robot.folder / "camera.py").write_text("import os\nraise OSError('no camera')\n")
    (robot.folder / "far.py").write_text(
        "class Far:\n    def __init__(self, port, speed): pass\n"
        "class Lost:\n    def __init__(self): raise OSError('no arm')\n"
    )
    child = await robot.launch(skill=target)
    async with asyncio.timeout(HANG_S):
        assert await child.wait() == 1
    log = (robot.folder / "python.log").read_text()
    assert text in log
    assert "Traceback" not in log
