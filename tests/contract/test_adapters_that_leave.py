import asyncio
import os
import signal
from pathlib import Path

import pytest
from adapter_process import started_adapter
from middleware_system import System, assert_ended
from processes import HANG_S

from aos_protocol.messages import MissionQuery, MissionState
from aos_runtime.adapters import Binding
from aos_runtime.processes.children import Child

ROBOT = "async def sense(call):\n    return {}\n"


async def launch(system: System, endpoint: str, folder: Path, robot: str = ROBOT) -> Child:
    (folder / "robot.py").write_text(robot)
    return await started_adapter(
        system.keys,
        endpoint,
        folder,
        "python",
        adapter="aos_skills.python_functions:PythonAdapter",
        folder=str(folder),
        bind={"/sense": Binding(target="robot.py:sense")},
    )


@pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
async def test_the_skills_of_an_adapter_that_leaves_wait_for_its_return(
    system: System, endpoint: str, tmp_path, death: signal.Signals
):
    child = await launch(system, endpoint, tmp_path)
    try:
        await system.can_run("sense")
        os.kill(child.pid, death)
        await system.state_when(lambda state: "sense" in state.unavailable and not state.returning)
        assert (await system.activate("sense", 1)).status == "refused"
        await system.bus.announce(system.keys.returning("python"))
        state = await system.state_when(lambda state: "sense" in state.returning)
        assert state.unavailable["sense"].endswith("of /sense: python is expected back")
        if death == signal.SIGSTOP:
            os.kill(child.pid, signal.SIGCONT)
        else:
            child = await launch(system, endpoint, tmp_path)
        state = await system.can_run("sense")
        assert state.returning == ()
        assert (await system.activate("sense", 2)).status == "observed"
    finally:
        child.kill()
        await child.wait()


@pytest.mark.parametrize("is_told", [True, False], ids=["told", "untold"])
async def test_a_call_that_an_adapter_finds_after_a_pause_does_not_begin_where_it_was_given_up(
    system: System, endpoint: str, tmp_path, is_told
):
    begun = tmp_path / "begun"

    async def state(_: MissionQuery, __: str) -> MissionState:
        return now

    if is_told:
        await system.bus.answer(system.keys.mission_state, MissionQuery, state)
    await system.bus.announce(system.keys.live("solver"))
    robot = (
        f"def sense(call):\n    print(call.id, file=open({str(begun)!r}, 'a'), flush=True)\n    return {{}}\n"
    )
    child = await launch(system, endpoint, tmp_path, robot)
    try:
        step = 0
        status = ""
        while status != "observed":  # While it starts, its paths may come and go.
            await system.can_run("sense")
            step += 1
            now = MissionState("m", "acting", step, 0.0)
            status = (await system.activate("sense", step)).status
        status = "refused"
        while status == "refused":  # The link was lost before the call went out.
            os.kill(child.pid, signal.SIGCONT)
            await system.can_run("sense")
            step += 1
            now = MissionState("m", "acting", step, 0.0)
            os.kill(child.pid, signal.SIGSTOP)
            status = (await system.activate("sense", step)).status
        now = MissionState("m", "holding", step, 0.0)
        await system.cannot_run("sense")
        os.kill(child.pid, signal.SIGCONT)
        await system.can_run("sense")
        given_up = step
        while status != "observed":
            step += 1
            now = MissionState("m", "acting", step, 0.0)
            status = (await system.activate("sense", step)).status
        assert f"m-{given_up}" not in begun.read_text().split()
    finally:
        child.kill()
        await child.wait()


async def test_an_adapter_that_ends_at_once_may_have_begun(system: System, endpoint: str, tmp_path):
    for step in range(1, 5):
        child = await launch(system, endpoint, tmp_path, "import os\ndef sense(call):\n    os._exit(1)\n")
        await system.can_run("sense")
        assert (await system.activate("sense", step)).status == "unknown"
        async with asyncio.timeout(HANG_S):
            await child.wait()
        await system.cannot_run("sense")


async def test_nobody_decides_for_the_first_skill_of_an_adapter_that_is_started_again(system: System):
    ready = system.keys.live("scripted")
    await system.adapter.announce("/sense")
    await system.bus.announce(ready)
    await system.can_run("sense")
    system.bus.withdraw(ready)
    await system.state_when(lambda state: "still starting" in state.unavailable.get("sense", ""))
    await system.adapter.announce("/serve")
    await system.bus.announce(ready)
    await system.state_when(lambda state: state.unavailable.keys().isdisjoint({"sense", "serve"}))


async def test_a_token_without_anybody_who_answers_is_no_adapter(system: System):
    await system.adapter.announce("/sense")
    await system.can_run("sense")
    assert_ended(await system.activate("sense", 1), "refused", "AOS505")
