import asyncio
import os
import signal
from typing import Any

import msgspec
import pytest
from mapping_documents import skill_of
from middleware_system import HANG_S, SENSE, System, answering, assert_ended, hang

from aos_protocol.codec import MAX_BYTES
from aos_protocol.errors import LostAnswerError, SkillError
from aos_protocol.messages import Activate, ActivationId, Cancelled, Outcome, SkillCall, SkillResult, Stray
from aos_runtime.disk.journal import Journal
from aos_runtime.parties.asking import ask_until_answered

JAMMED = """\
project: armadillo
response: jammed
response_rule: __skill_status == 'failed' and 'jam' in __skill_error
response: late
response_rule: __skill_status == 'timed_out'
module_activation: skill
path: /sense
max_duration: 0.3
"""
DONE = "response: done\nresponse_rule: True\n"


async def with_mapping(system: System, text: str):
    project = system.registry.current.project
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(text, "sense.am"),)))
    await system.state(system.registry.current.revision)


@pytest.mark.parametrize("behind", ["project: armadillo\n", "== 'timed_out'\n"])
async def test_a_rule_can_tell_how_a_skill_has_ended(system: System, behind):
    async def ending(call: SkillCall) -> dict[str, Any]:
        if call.id.step < 3:
            raise SkillError("the gripper is jammed" if call.id.step == 1 else "no power", code="AOS510")
        return await hang(call) if call.id.step == 3 else {}

    await with_mapping(system, JAMMED.replace(behind, behind + DONE))
    await system.adapter.serve("/sense", ending)
    await system.adapter.serve_cancel("/sense")
    outcomes = [await system.activate("sense", step) for step in (1, 2, 3, 4)]
    # No rule that names the status tells of the second.
    assert [each.response for each in outcomes] == ["jammed", "", "late", "done"]
    faults = [each.fault for each in outcomes[:2]]
    assert [each.status for each in outcomes[:2]] == ["observed", "failed"]
    assert [(fault.code, fault.message) for fault in faults if fault is not None] == [
        ("AOS510", "the gripper is jammed"), ("AOS510", "no power"),
    ]  # fmt: skip


async def test_an_adapter_that_leaves_and_a_second_one_of_a_path_make_its_skills_unavailable(system: System):
    await system.adapter.serve("/sense", answering({}))
    await system.can_run("sense")
    system.adapter.withdraw("/sense")
    state = await system.cannot_run("sense")
    assert state.unavailable["sense"] == "no adapter answers calls of /sense"
    assert state.announced["sense"] == 1
    await system.adapter.announce("/sense")
    state = await system.can_run("sense")
    assert state.announced["sense"] == 2
    await system.adapter.announce("/sense", "other")
    await system.state_when(lambda state: "is served by" in state.unavailable.get("sense", ""))
    outcome = await system.activate("sense", 1)
    both = " and ".join(f"{name} 1 (instance {system.adapter.instance})" for name in ("scripted", "other"))
    assert_refused(outcome, "AOS511", f"/sense is served by {both}")
    system.adapter.withdraw("/sense", "other")
    await system.can_run("sense")
    assert (await system.activate("sense", 2)).status == "observed"


async def test_an_adapter_that_is_there_tells_why_it_does_not_serve_a_path(system: System):
    await system.adapter.lack("/sense", "AOS509: /sense is of type a/B, not c/D")
    state = await system.state_when(lambda state: "AOS509" in state.unavailable.get("sense", ""))
    why = "no adapter answers calls of /sense: scripted says: AOS509: /sense is of type a/B, not c/D"
    assert (state.unavailable["sense"], "sense" in state.for_good) == (why, True)
    assert_refused(await system.activate("sense", 1), "AOS505", why)


async def test_nothing_moves_while_a_skill_may_still_be_moving(system: System):
    waiting, is_still = await system.beside_a_motion("sense")
    assert [call.id.step for call in system.adapter.calls] == [1]
    is_still.set()
    assert (await waiting).status == "observed"


async def test_an_adapter_that_has_left_when_it_is_known_to_stand_still_is_not_called(system: System):
    waiting, is_still = await system.beside_a_motion("sense")
    system.adapter.withdraw("/sense")
    await system.cannot_run("sense")
    is_still.set()
    assert_refused(await waiting, "AOS505", "no adapter answers calls of /sense")


async def test_an_adapter_that_ends_since_it_cannot_stop_is_called_when_it_is_started_again(system: System):
    waiting, is_still = await system.beside_a_motion("sense", deadline_s=1e-3)
    system.adapter.withdraw("/sense")
    await system.cannot_run("sense")
    is_still.set()
    await system.logged("/sense of m-1 has stopped")
    await system.adapter.announce("/sense")
    await waiting
    assert [call.deadline_s for call in system.adapter.calls if call.id.step == 2] == [1e-3]


async def test_while_an_adapter_cannot_be_cancelled_no_skill_is_available(system: System):
    await system.adapter.serve(
        "/sense", lambda call: hang(call) if call.id.step == 1 else answering({})(call)
    )
    assert (await system.activate("sense", 1)).status == "timed_out"
    assert_refused(await system.activate("sense", 2), "AOS512", "/sense may still be moving")
    await system.state_when(lambda state: "/sense may still" in state.unavailable.get("sense", ""))
    await system.adapter.serve_cancel("/sense")
    await system.can_run("sense")
    assert (await system.activate("sense", 3)).status == "observed"


async def test_a_call_of_a_middleware_that_a_signal_has_frozen_is_joined_and_no_adapter_is_lost(
    process_system: System,
):
    is_over = asyncio.Event()

    async def pick(_: SkillCall) -> dict[str, Any]:
        await is_over.wait()
        return {"success": True}

    await process_system.adapter.serve("/pick", pick)
    key, live, request = (
        process_system.keys.activate("pick"),
        process_system.keys.live("middleware"),
        Activate(ActivationId("m", 1), "pick", {}, HANG_S),
    )
    asked = ask_until_answered(process_system.bus, key, request, Outcome, server=live, timeout_s=HANG_S)
    waiting = asyncio.create_task(asked)
    await asyncio.wait_for(process_system.adapter.is_called.wait(), HANG_S)
    assert process_system.child is not None
    async with asyncio.timeout(HANG_S), process_system.bus.presence(live) as presence:
        os.kill(process_system.child.pid, signal.SIGSTOP)
        while (await anext(presence))[1]:
            pass
        os.kill(process_system.child.pid, signal.SIGCONT)
        while not (await anext(presence))[1]:
            pass
    is_over.set()
    outcome = await waiting
    assert (outcome.status, outcome.fault) == ("observed", None)


async def test_a_result_of_another_type_is_not_put_on_a_topic_that_said_nothing(system: System):
    result = "local_variable: wet\nfrom_ros_service_response: true\ncode:\nwet = __input.wet\n"
    topic = "local_variable: level\ntopic: /level\ntype: float\ncode:\nlevel = __input.data\n"
    rule = "response: wet\nresponse_rule: wet > 0.5 and level > 0\nmodule_activation: skill\npath: /sense\n"
    await with_mapping(system, f"project: armadillo\n{rule}{result}{topic}")
    await system.adapter.serve("/sense", answering({"wet": "very"}))
    outcome = await system.activate("sense")
    assert outcome.fault is not None
    assert outcome.fault.message.endswith("'str' and 'float'; wet is \"very\"")


@pytest.mark.parametrize("kind", ["late", "foreign"])
async def test_a_late_reply_and_one_for_another_id_are_kept_and_not_used(system: System, kind):
    is_over = asyncio.Event()

    async def sense(call: SkillCall) -> dict[str, Any]:
        if kind == "late" and call.id.step == 1:
            await is_over.wait()
        return {}

    def for_another(result: SkillResult) -> SkillResult:
        other = msgspec.structs.replace(result.id, mission="another")
        return (
            msgspec.structs.replace(result, id=other) if kind == "foreign" and result.id.step == 1 else result
        )

    await with_mapping(system, SENSE)
    await system.adapter.serve("/sense", sense, for_another)
    await system.adapter.serve_cancel("/sense")
    outcome = await system.activate("sense", 1)
    assert outcome.status == ("timed_out" if kind == "late" else "unknown")
    is_over.set()
    await system.logged(f"a {kind} reply")
    assert (await system.activate("sense", 2)).status == "observed"
    with Journal.read(system.run_dir / "middleware.db") as journal:
        (stray,) = [msgspec.json.decode(row.payload, type=Stray) for row in journal.rows("stray")]
    assert (stray.id, stray.kind, stray.path) == (outcome.id, kind, "/sense")


async def test_a_reply_that_cannot_be_read_says_nothing_of_the_skill(system: System):
    no_result: Any = Cancelled()
    await system.adapter.serve("/sense", answering({}), lambda _: no_result)
    assert_ended(await system.activate("sense", 1), "unknown", "AOS602", "docs/protocol.md")


async def test_a_call_that_is_dropped_by_an_adapter_that_stays_is_no_loss_of_the_adapter(system: System):
    async def drop(call: SkillCall) -> dict[str, Any]:
        raise LostAnswerError("nothing more comes")

    await system.adapter.serve("/sense", drop)
    assert_ended(await system.activate("sense", 1), "unknown", "AOS504", "dropped the call")


async def test_a_call_that_is_too_large_for_the_bus_is_refused_and_leaves_no_doubt(system: System):
    large = f"module_activation: skill\npath: /sense\nparameter: map\ncode:\n'x' * {MAX_BYTES}\n"
    await with_mapping(system, "project: armadillo\nresponse: done\nresponse_rule: True\n" + large)
    await system.adapter.serve("/sense", answering({}))
    assert_refused(await system.activate("sense", 1), "AOS502", "too large for the bus")
    await with_mapping(system, SENSE)
    assert (await system.activate("sense", 2)).status == "observed"


def assert_refused(outcome: Outcome, code: str, text: str):
    assert_ended(outcome, "refused", code, text)
