import asyncio
import sys
from collections.abc import Awaitable
from typing import Any

import msgspec
import pytest
from mapping_documents import skill_of
from middleware_system import SENSE, System, answering, assert_ended, hang, succeed

from aos_middleware.robot.served_paths import ServedPaths
from aos_protocol.errors import AosError, LostAnswerError, SkillError
from aos_protocol.messages import Outcome, SkillCall
from aos_runtime.processes.children import PIPE, Child

HANGING_ADAPTER = """
import asyncio, sys
from aos_protocol.keys import Keys, Serving
from aos_protocol.messages import SkillCall
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.parent import die_with_parent

async def main():
    async def hang(call, key):
        await bus.announce(Keys("test").live("called"))  # The router has the receipt.
        print("called", flush=True)
        await asyncio.Event().wait()

    async with await Bus.open(sys.argv[1], sender="adapter") as bus:
        await bus.answer(Keys("test").call("/serve"), SkillCall, hang)
        await bus.announce(Keys("test").serve(Serving("doomed", "1", bus.instance, "/serve")))
        print("serving", flush=True)
        await asyncio.Event().wait()

die_with_parent()
asyncio.run(main())
"""


async def test_a_new_revision_is_used_and_the_one_before_it_stays_for_the_running_model(system: System):
    state = await system.state(1)
    skills = ("navigate", "observe_arm_outstretched", "observe_holding", "pick", "sense", "serve")
    assert (state.revision, state.skills, state.refused) == (1, skills, 0)
    assert state.unavailable.keys() == set(skills)
    folder = system.run_dir / "generated" / "python"
    assert sorted(path.stem for path in folder.iterdir()) == list(state.skills)
    await system.adapter.serve("/sense", answering({}))
    assert (await system.activate("sense", 1)).response == "quiet"
    renamed = skill_of(SENSE.replace("quiet", "silent"), "sense.am")
    others = tuple(skill for skill in system.registry.current.project.skills if skill.name != "sense")
    project = msgspec.structs.replace(system.registry.current.project, skills=(*others, renamed))
    system.registry.announce(project)
    await system.state(2)
    assert (await system.activate("sense", 2)).response == "silent"
    assert (await system.activate("sense", 3, revision=2)).response == "silent"
    assert (await system.activate("sense", 4, revision=1)).response == "quiet"


async def test_a_revision_that_cannot_be_loaded_changes_nothing_and_is_reported(system: System):
    await system.adapter.serve("/sense", answering({}))
    text = SENSE.replace("path:", "imports: import: no_such_module_at_all\npath:")
    project = system.registry.current.project
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(text, "sense.am"),)))
    assert (await system.refusal(2)).revision == 1
    await system.logged("revision 2 is not used")
    await system.logged("sense.am:7")
    assert (await system.activate("sense")).response == "quiet"


async def test_a_new_middleware_tells_no_skill_as_lost_of_whose_adapter_it_has_not_heard_yet(
    system: System, monkeypatch: pytest.MonkeyPatch
):
    await system.adapter.serve("/sense", succeed)
    await system.stop()
    hears = asyncio.Event()
    follow = ServedPaths.follow

    async def follow_later(served: ServedPaths):
        await hears.wait()
        await follow(served)

    monkeypatch.setattr(ServedPaths, "follow", follow_later)
    loaded = system.log.count("revision 1: mappings")
    await system.host()
    asking = asyncio.create_task(system.state(1))
    await system.logged("revision 1: mappings", loaded + 1)
    hears.set()
    assert "sense" not in (await asking).unavailable


async def test_a_repeated_id_brings_the_first_outcome_again_and_moves_nothing(process_system: System):
    await process_system.adapter.serve("/pick", succeed)
    first = await process_system.activate("pick")
    assert await process_system.activate("pick") == first
    # An id that stands for another motion moves nothing, and is a step of the mission.
    assert_ended(await process_system.activate("serve"), "refused", "AOS514")
    await process_system.stop()
    await process_system.start()
    await process_system.state(1)
    assert await process_system.activate("pick") == first
    assert len(process_system.adapter.calls) == 1


async def test_a_repeat_during_the_activation_waits_for_its_outcome(system: System):
    go_on = asyncio.Event()

    async def wait(_: SkillCall) -> dict[str, Any]:
        await go_on.wait()
        return {"success": True}

    await system.adapter.serve("/pick", wait)
    async with asyncio.TaskGroup() as tasks:
        first = tasks.create_task(system.activate("pick"))
        await system.adapter.is_called.wait()
        second = tasks.create_task(system.activate("pick"))
        with pytest.raises(SkillError, match="running already, for activation m-1"):
            await system.activate("pick", step=2)
        go_on.set()
    assert first.result() == second.result()
    assert first.result().response == "pick_succeeded"
    assert len(system.adapter.calls) == 1


@pytest.mark.parametrize(
    ("ending", "skill", "result"),
    [("killed", "pick", ("observed", "pick_succeeded")), ("stopped", "sense", ("unknown", ""))],
    ids=["killed, its_result_tells_all", "stopped, its_topics_were_missed"],
)
async def test_a_new_middleware_joins_the_motion_of_the_one_that_is_gone(
    process_system: System, ending, skill, result
):
    may_end = asyncio.Event()

    async def move(_: SkillCall) -> dict[str, Any]:
        await may_end.wait()
        return {"success": True}

    await process_system.adapter.serve(f"/{skill}", move)
    assert process_system.child is not None
    async with asyncio.TaskGroup() as tasks:
        cut_off = tasks.create_task(_error_of(process_system.activate(skill)))
        await process_system.adapter.is_called.wait()
        if ending == "killed":
            process_system.child.kill()
        status = await process_system.child.stop(5.0)
    assert status == (-9 if ending == "killed" else 0)
    assert isinstance(cut_off.result(), LostAnswerError)
    process_system.adapter.is_called.clear()
    await process_system.start()
    await process_system.state(1)
    async with asyncio.TaskGroup() as tasks:
        taken_up = tasks.create_task(process_system.activate(skill))
        await process_system.adapter.is_called.wait()
        may_end.set()
    assert (taken_up.result().status, taken_up.result().response) == result
    assert len(process_system.adapter.motions) == 1


async def test_what_a_new_middleware_cannot_call_may_have_been_called_before(process_system: System):
    await process_system.adapter.serve("/pick", hang)
    assert process_system.child is not None
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(_error_of(process_system.activate("pick")))
        await process_system.adapter.is_called.wait()
        process_system.child.kill()
        await process_system.child.stop(5.0)
    process_system.adapter.withdraw("/pick")
    await process_system.start()
    await process_system.state(1)
    assert_ended(await process_system.activate("pick"), "unknown", "AOS505")


async def test_an_adapter_killed_during_the_call_leaves_the_outcome_unknown(system: System, endpoint: str):
    adapter = await Child.start([sys.executable, "-c", HANGING_ADAPTER, endpoint], stdout=PIPE)
    assert await adapter.stdout.readline() == b"serving\n"
    async with asyncio.TaskGroup() as tasks:
        activation = tasks.create_task(system.activate("serve"))
        assert await adapter.stdout.readline() == b"called\n"
        adapter.kill()
    assert_ended(activation.result(), "unknown", "AOS504")


async def _error_of(asked: Awaitable[Outcome]) -> AosError:
    with pytest.raises(AosError) as error:
        await asked
    return error.value
