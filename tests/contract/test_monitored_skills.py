import asyncio
from typing import Any

import msgspec
from mapping_documents import mapping_of, skill_of
from middleware_system import HANG_S, SENSE, System
from test_stopped_skills import DRIVE, Driving

from aos_protocol.messages import Outcome, SkillCall, SkillResult

BATTERY = """\
project: armadillo
monitor: battery
response: empty
response_rule: level < 0.1
response: low
response_rule: level < 0.2
response: fine
response_rule: level > 0.2
stop_when: level < 0.1
local_variable: level
topic: /battery
message_type: Battery
code:
return __input.level
"""


async def monitored(system: System) -> Driving:
    project = system.registry.current.project
    sense = skill_of(SENSE.replace("level <= 3", "True"), "sense.am")
    skills = (skill_of(DRIVE, "drive.am"), sense)
    monitor = mapping_of(BATTERY, "battery.am")
    system.registry.announce(msgspec.structs.replace(project, skills=skills, monitors=(monitor,)))
    state = await system.state(system.registry.current.revision)
    assert state.skills == ("drive", "sense")
    adapter = Driving(system)
    await adapter.serve()
    return adapter


async def sensed(system: System, step: int, *levels: Any, response: str = "") -> Outcome:
    """The outcome of a skill during which the battery has these levels; with a `response` it is played."""

    async def answer(_: SkillCall) -> dict[str, Any]:
        for level in levels:
            system.adapter.publish("/battery", {"level": level})
        return {}

    def played(result: SkillResult) -> SkillResult:
        return msgspec.structs.replace(
            result, response=response, monitors={"battery": "low"} if response else {}
        )

    await system.adapter.serve("/sense", answer, played)
    return await system.activate("sense", step)


async def test_the_newest_message_of_a_step_gives_one_response_and_silence_none(system: System):
    await monitored(system)
    answers = iter([(), (0.9, 0.15), (), (0.15, 0.9), (0.2,)])

    async def answer(_: SkillCall) -> dict[str, Any]:
        for level in next(answers):
            system.adapter.publish("/battery", {"level": level})
        return {}

    await system.adapter.serve("/sense", answer)
    outcomes = [await system.activate("sense", step) for step in range(1, 6)]
    # 0.2 is no level that a rule speaks of.
    assert [outcome.monitors for outcome in outcomes] == [{}, {"battery": "low"}, {}, {"battery": "fine"}, {}]
    assert {outcome.status for outcome in outcomes} == {"observed"}
    assert await system.activate("sense", 2) == outcomes[1]


async def test_a_monitor_stops_what_runs_and_says_so_with_the_same_outcome(system: System):
    adapter = await monitored(system)
    running = asyncio.create_task(system.activate("drive", 1))
    await asyncio.wait_for(adapter.is_called.wait(), HANG_S)
    system.adapter.publish("/battery", {"level": 0.5})
    system.adapter.publish("/battery", {"level": 0.05})
    outcome = await running
    # The mapping of the skill has a rule for its own `stop_when` alone.
    assert (outcome.status, outcome.monitors) == ("cancelled", {"battery": "empty"})
    assert outcome.fault is not None
    assert outcome.fault.message == "drive: stop_when of battery holds, and no rule says what was observed"
    # The battery is empty still, and has been told: the next skill may be the one that charges it.
    running = asyncio.create_task(system.activate("drive", 2))
    adapter.is_called.clear()
    await asyncio.wait_for(adapter.is_called.wait(), HANG_S)
    system.adapter.publish("/battery", {"level": 0.04})
    await system.logged("battery")
    adapter.arrive(adapter.call)
    outcome = await running
    assert (outcome.status, outcome.response) == ("observed", "arrived")
    assert len(adapter.asked) == 1


async def test_what_becomes_true_between_two_skills_keeps_the_next_one_from_being_called(system: System):
    adapter = await monitored(system)
    # What is said before the monitor listens is not heard.
    assert (await sensed(system, 1, 0.9)).monitors == {"battery": "fine"}
    system.adapter.publish("/battery", {"level": 0.05})
    # Two processes speak: where the message comes late, it stops the skill that was called.
    stopped = await system.activate("drive", 2)
    if not adapter.asked:
        assert not adapter.is_called.is_set()
        assert stopped.status == "refused"
    assert stopped.monitors == {"battery": "empty"}


async def test_a_monitor_that_fails_says_nothing_is_told_and_begins_anew(system: System):
    await monitored(system)
    answers = iter([("empty",), (0.9,)])

    async def answer(_: SkillCall) -> dict[str, Any]:
        for level in next(answers):
            system.adapter.publish("/battery", {"level": level})
        return {}

    await system.adapter.serve("/sense", answer)
    outcome = await system.activate("sense", 1)
    assert (outcome.status, outcome.monitors) == ("observed", {})
    assert "battery.am:9:12: TypeError" in outcome.monitor_faults["battery"]
    outcome = await system.activate("sense", 2)
    assert (outcome.monitors, outcome.monitor_faults) == ({"battery": "fine"}, {})


async def test_a_skill_that_is_played_brings_the_responses_of_monitors_that_its_adapter_knows(system: System):
    await monitored(system)
    outcome = await sensed(system, 1, response="heard")
    assert (outcome.response, outcome.monitors) == ("heard", {"battery": "low"})


async def test_a_monitor_is_exchanged_by_a_push_and_goes_with_it(system: System):
    await monitored(system)

    async def answer(_: SkillCall) -> dict[str, Any]:
        system.adapter.publish("/battery", {"level": 0.5})
        return {}

    await system.adapter.serve("/sense", answer)
    assert (await system.activate("sense", 1)).monitors == {"battery": "fine"}
    project = system.registry.current.project
    other = mapping_of(BATTERY.replace("response: fine", "response: half"), "battery.am")
    for step, monitors in ((2, (other,)), (3, ()), (4, (other,))):
        system.registry.announce(msgspec.structs.replace(project, monitors=monitors))
        await system.state(system.registry.current.revision)
        outcome = await system.activate("sense", step)
        assert outcome.status == "observed"
        assert outcome.monitors == ({"battery": "half"} if monitors else {})
