import asyncio

import msgspec
import pytest
from mapping_documents import skill_of
from middleware_system import HANG_S, System, assert_ended

from aos_protocol.errors import SkillError
from aos_protocol.messages import Cancel, Cancelled, Outcome, SkillCall, SkillResult, TopicMessage

DRIVE = """\
project: armadillo
response: halted
response_rule: __skill_status == 'stopped' and 'stop_when of drive' in __skill_error
response: arrived
response_rule: success
stop_when: distance_m < 0.5
module_activation: skill
path: /drive
local_variable: success
from_ros_service_response: true
code:
success = __input.success
local_variable: distance_m
topic: /laser
message_type: Range
code:
return __input.data
"""


class Driving:
    """An adapter whose skill ends when it is cancelled, or when the test says so.

    It answers so many cancellations as if it knew no such call as `has_missed` says.
    """

    def __init__(self, system: System):
        self.system = system
        self.is_called = asyncio.Event()
        self.asked: list[Cancel] = []
        self.has_missed = 0
        self._end: asyncio.Future[SkillResult] | None = None
        self._sent = 0

    async def serve(self):
        bus, keys = self.system.adapter._bus, self.system.keys
        await bus.answer(keys.call("/drive"), SkillCall, self._call)
        await bus.answer(keys.cancel("/drive"), Cancel, self._cancel)
        await self.system.adapter.announce("/drive")
        await self.system.can_run("drive")

    def say(self, distance_m: object):
        self._sent += 1
        message = TopicMessage(self._sent, {"data": distance_m})
        self.system.adapter._bus.tell(self.system.keys.topic("/laser"), message)

    def arrive(self, call: SkillCall):
        assert self._end is not None
        self._end.set_result(SkillResult(call.id, {"success": True}, {"/laser": self._sent}))

    async def _call(self, call: SkillCall, _: str) -> SkillResult:
        self._end = asyncio.get_running_loop().create_future()
        self.call = call
        self.is_called.set()
        return await self._end

    async def _cancel(self, cancel: Cancel, _: str) -> Cancelled:
        self.asked.append(cancel)
        if self._end is None or self._end.done() or len(self.asked) <= self.has_missed:
            return Cancelled()
        self._end.set_exception(SkillError("/drive was cancelled", code="AOS507"))
        return Cancelled((str(cancel.id),))


async def driving(system: System, mapping: str = DRIVE) -> Driving:
    project = system.registry.current.project
    skills = (*(skill for skill in project.skills if skill.name == "sense"), skill_of(mapping, "drive.am"))
    system.registry.announce(msgspec.structs.replace(project, skills=skills))
    await system.state(system.registry.current.revision)
    adapter = Driving(system)
    await adapter.serve()
    return adapter


async def outcome_of(adapter: Driving, *messages: object, step: int = 1, ends: bool = False) -> Outcome:
    """The outcome of a drive on which the laser says this; with `ends` it arrives by itself then."""
    adapter.is_called.clear()
    running = asyncio.create_task(adapter.system.activate("drive", step))
    await asyncio.wait_for(adapter.is_called.wait(), HANG_S)
    for message in messages:
        adapter.say(message)
    if ends:
        adapter.arrive(adapter.call)
    return await running


async def test_a_message_that_makes_it_true_stops_the_skill_once_and_rules_say_what_was_observed(
    system: System,
):
    adapter = await driving(system)
    outcome = await outcome_of(adapter, 3.0, 0.4, 0.3, 2.0)
    assert (outcome.status, outcome.response, outcome.stopped_by) == ("observed", "halted", "drive")
    assert outcome.fault is None
    (cancel,) = adapter.asked
    assert (cancel.id, cancel.reason) == (outcome.id, "drive: stop_when of drive holds")
    # What is said before each topic has spoken stops nothing, and the next activation begins anew.
    outcome = await outcome_of(adapter, step=2, ends=True)
    assert (outcome.response, outcome.stopped_by) == ("arrived", "")
    assert len(adapter.asked) == 1
    # A skill that ends by itself has ended by itself.
    outcome = await outcome_of(adapter, 0.1, step=3, ends=True)
    assert (outcome.status, outcome.response, outcome.stopped_by) == ("observed", "arrived", "")
    assert outcome.local_variables["distance_m"] == "0.1"


async def test_a_cancellation_that_overtakes_its_call_is_said_again(system: System):
    adapter = await driving(system)
    adapter.has_missed = 2
    assert (await outcome_of(adapter, 0.1)).response == "halted"
    assert len(adapter.asked) == 3


async def test_a_skill_is_not_called_where_it_would_be_stopped_at_once(system: System):
    adapter = await driving(system)
    running, is_still = await system.beside_a_motion("drive")
    adapter.say(0.1)
    await system.logged("m-2 is stopped: drive: stop_when of drive holds")
    is_still.set()
    outcome = await running
    assert (outcome.status, outcome.response, outcome.stopped_by) == ("observed", "halted", "drive")
    assert not adapter.is_called.is_set()
    assert adapter.asked == []


@pytest.mark.parametrize(
    ("mapping", "status", "code", "text"),
    [
        (DRIVE.replace("__skill_status == 'stopped' and", "__skill_status == 'failed' and"),
         "cancelled", "AOS507", "drive: stop_when of drive holds, and no rule says what was observed"),
        (DRIVE.replace("distance_m < 0.5", "distance_m.metres < 0.5"),
         "unknown", "AOS401", "drive.am:6:12: AttributeError: 'float' object has no attribute 'metres'"),
        (DRIVE.replace("distance_m < 0.5", "distance_m"),
         "unknown", "AOS401", "drive.am:6:12: TypeError: stop_when is 0.1, which is neither True nor False"),
    ],
)  # fmt: skip
async def test_what_cannot_be_told_is_an_error_at_its_place_and_the_service_goes_on(
    system: System, mapping, status, code, text
):
    adapter = await driving(system, mapping)
    outcome = await outcome_of(adapter, 0.1, ends=code == "AOS401")
    assert_ended(outcome, status, code, text)
    assert (await outcome_of(adapter, step=2, ends=True)).response == "arrived"
