"""An adapter whose process ends or freezes: its skills are unavailable until somebody serves them."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from pathlib import Path

import msgspec
import pytest
from middleware_system import System
from processes import HANG_S

from aos_runtime.adapters import AdapterSettings, Binding
from aos_runtime.children import Child

ROBOT = "async def sense(call):\n    return {}\n"


async def launch(system: System, endpoint: str, folder: Path, robot: str = ROBOT) -> Child:
    """An adapter process that serves /sense."""
    (folder / "robot.py").write_text(robot)
    values = AdapterSettings(
        robot=system.keys.robot,
        service="python",
        endpoint=endpoint,
        run_dir=str(folder),
        adapter="aos_skills.python_functions:PythonAdapter",
        folder=str(folder),
        bind={"/sense": Binding(target="robot.py:sense")},
    )
    path = folder / "python.json"
    path.write_bytes(msgspec.json.encode(values))
    return await Child.start([sys.executable, "-m", "aos_runtime.adapters", str(path)])


@pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
async def test_the_skills_of_an_adapter_that_leaves_wait_for_its_return(
    system: System, endpoint: str, tmp_path: Path, death: signal.Signals
) -> None:
    child = await launch(system, endpoint, tmp_path)
    try:
        await system.state_when(lambda state: "sense" not in state.unavailable)
        os.kill(child.pid, death)
        await system.state_when(lambda state: "sense" in state.unavailable)
        assert (await system.activate("sense", 1)).status == "refused"
        if death == signal.SIGSTOP:
            os.kill(child.pid, signal.SIGCONT)
        else:
            child = await launch(system, endpoint, tmp_path)
        await system.state_when(lambda state: "sense" not in state.unavailable)
        assert (await system.activate("sense", 2)).status == "observed"
    finally:
        child.kill()
        await child.wait()


async def test_an_adapter_that_ends_at_once_may_have_begun(
    system: System, endpoint: str, tmp_path: Path
) -> None:
    for step in range(1, 5):
        child = await launch(system, endpoint, tmp_path, "import os\ndef sense(call):\n    os._exit(1)\n")
        await system.state_when(lambda state: "sense" not in state.unavailable)
        assert (await system.activate("sense", step)).status == "unknown"
        async with asyncio.timeout(HANG_S):
            await child.wait()
        await system.state_when(lambda state: "sense" in state.unavailable)


async def test_a_token_without_anybody_who_answers_is_no_adapter(system: System) -> None:
    await system.adapter.announce("/sense")
    await system.state_when(lambda state: "sense" not in state.unavailable)
    outcome = await system.activate("sense", 1)
    assert outcome.status == "refused"
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS505"
