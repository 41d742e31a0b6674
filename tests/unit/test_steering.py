import asyncio
from typing import Any, cast
from unittest.mock import create_autospec

import msgspec
import pytest
from decision_records import decision_record

from aos_protocol.errors import SteeringError
from aos_protocol.messages import ActionRefused, ActivationId, Message, MissionState, Outcome, Steer
from aos_protocol.mission_rows import REFUSED, STEERED
from aos_runtime.disk.journal import JournalRow
from aos_solver.child.answers.models import EngineDescription, GroundedAction
from aos_solver.mission.control.helm import Helm
from aos_solver.mission.control.steering import Steering
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.records.memory import folded
from aos_solver.mission_runner import MissionRunner
from aos_solver.steering_desk import SteeringDesk

MODEL = EngineDescription(
    "p",
    10,
    0.9,
    (
        GroundedAction("go(to=a)", "go", {"to": "a"}),
        GroundedAction("go(to=b)", "go", {"to": "b"}),
        GroundedAction("look", "look", {}),
    ),
    {},
)


def steered(*steers: Steer) -> Steering:
    steering = Steering()
    for steer in steers:
        steering = steering.after(steer, is_holding=False)
    return steering


def script(*actions: str) -> Steer:
    return Steer("script", actions, by="ana", request="s")


def record(action: str, chosen_by: str, status: str = "") -> Any:
    outcome = Outcome(ActivationId("m", 1), action, status) if status else None
    return decision_record(0, action=action, chosen_by=chosen_by, outcome=outcome)


def test_a_held_mission_waits_but_for_what_is_asked_for_and_the_steps_it_is_given():
    held = steered(Steer("hold", by="ana"))
    assert held.waits
    one_more = held.after(Steer("step", by="ben"), is_holding=True)
    assert (one_more.waits, one_more.held_by) == (False, "ana")
    assert one_more.decided(record("look", "planner")).waits
    asked = held.after(Steer("act", ("look",), by="ben"), is_holding=True)
    assert not asked.waits
    assert asked.decided(record("look", "operator")).waits
    assert not held.after(Steer("resume", by="ben"), is_holding=True).waits


def test_a_step_of_a_mission_that_nobody_holds_holds_it_afterwards():
    stepping = steered(Steer("step", by="ana"))
    assert not stepping.waits
    assert stepping.decided(record("look", "planner")).waits


def test_hold_drops_what_was_asked_for():
    held = steered(script("look", "look"), Steer("hold", by="ana"))
    assert held.waits
    assert held.queue == ()


def test_an_action_does_not_end_the_hold_for_a_skill():
    acting = Steering().after(Steer("act", ("look",), by="ana"), is_holding=True)
    assert acting.decided(record("look", "operator")).waits


@pytest.mark.parametrize(("status", "left"), [("observed", 1), ("failed", 0), ("unknown", 0)])
def test_a_script_ends_where_an_action_brings_no_observation(status, left):
    running = steered(script("look", "go(to=a)"), Steer("act", ("go(to=b)",), by="ben", request="r"))
    after = running.decided(record("look", "script")).observed(record("look", "script", status))
    assert len(after.queue) == left + 1
    assert after.held_by == ("" if left else "the script of ana")


def test_a_refused_action_drops_its_script_and_holds():
    running = steered(script("look", "go(to=a)"))
    after = running.refused(ActionRefused("look", "s", "why"))
    assert after.waits
    assert after.held_by == "the script of ana"


def test_the_fold_of_a_journal_is_the_steering_of_the_mission():
    steers: list[tuple[str, Message]] = [
        (STEERED, Steer("leave_out", name="look", by="ana", request="1")),
        (STEERED, Steer("leave_out", name="go(to=b)", by="ben", request="2")),
        (STEERED, Steer("take_back", name="look", by="ben", request="3")),
        (STEERED, script("go(to=a)", "go(to=a)")),
        ("decision", record("go(to=a)", "script")),
        (REFUSED, ActionRefused("go(to=a)", "s", "why")),
    ]
    rows = [
        JournalRow(number, 0, kind, msgspec.json.encode(said))
        for number, (kind, said) in enumerate(steers, 1)
    ]
    steering = folded(rows).steering
    assert steering.left_out == {"go(to=b)": "ben"}
    assert steering.waits
    assert steering.requests == ("1", "2", "3", "s")
    assert steering.refusals["s"].why == "why"


def test_a_hold_for_a_skill_is_over_once_somebody_has_resumed_the_mission():
    holding = MissionState("m", "holding", 1, 0.0)
    said: list[tuple[str, Message]] = [("mission", holding), (STEERED, Steer("leave_out", name="look"))]
    for verb, is_held in (("leave_out", True), ("resume", False)):
        said[1] = (STEERED, Steer(verb, by="ana"))
        entries = [*said, ("mission", holding)]
        rows = [
            JournalRow(n, 0, kind, msgspec.json.encode(each)) for n, (kind, each) in enumerate(entries, 1)
        ]
        assert folded(rows).is_held == is_held


class Journal(QuietPorts):
    def __init__(self):
        self.rows: list[tuple[str, Message]] = []

    def journal(self, kind: str, payload: Message):
        self.rows.append((kind, payload))


def test_one_request_acts_once():
    journal = Journal()
    helm = Helm(Steering(), journal, lambda steering: None)
    step = Steer("step", by="ana", request="r")
    assert [helm.take(step, MODEL, is_holding=False) for _ in range(2)] == [True, False]
    assert journal.rows == [(STEERED, step)]
    assert helm.now.steps == 1


@pytest.mark.parametrize(
    ("steer", "says"),
    [
        (Steer("act", ("loook",)), "there is no action loook"),
        (Steer("act", ()), "`act` with 0 actions"),
        (Steer("script", ("look", "go(to=c)")), r"action 2 of the script: there is no action go\(to=c\)"),
        (Steer("leave_out", name="fly"), "there is no skill or action fly"),
        (Steer("take_back", name="go"), "go is not left out"),
    ],
)
def test_what_cannot_be_done_is_refused_and_changes_nothing(steer, says):
    journal = Journal()
    helm = Helm(Steering(), journal, lambda steering: None)
    with pytest.raises(SteeringError, match=says) as refused:
        helm.take(steer, MODEL, is_holding=False)
    assert refused.value.code == "AOS517"
    assert refused.value.hint or not steer.actions
    assert (journal.rows, helm.now) == ([], Steering())


async def test_whoever_asks_for_an_action_hears_when_it_is_decided_for_or_why_not():
    helm = Helm(Steering(), Journal(), lambda steering: None)
    for request in ("1", "2", "3"):
        helm.take(Steer("act", ("look",), by="ana", request=request), MODEL, is_holding=False)
    waiting = [asyncio.create_task(helm.until_decided(request)) for request in ("1", "2", "3")]
    await asyncio.sleep(0)
    helm.decided(record("look", "operator"))
    await waiting[0]
    assert helm.asked is not None
    helm.refuse(helm.asked, "never x: too much", "")
    with pytest.raises(SteeringError, match="look is refused: never x: too much") as refused:
        await waiting[1]
    assert refused.value.code == "AOS518"
    helm.end(MissionState("m", "ended", 1, 0.0, "goal"))
    with pytest.raises(SteeringError, match="the mission has ended before: goal"):
        await waiting[2]


@pytest.mark.parametrize(
    ("phase", "said"), [("waiting", "no mission has begun. Wait"), ("ended", "no mission runs")]
)
async def test_the_desk_says_whether_a_mission_is_over_or_has_not_begun(phase, said):
    missions: Any = create_autospec(MissionRunner, instance=True)
    missions.running.return_value = None
    missions.state = MissionState("m", phase, 0, 0.0)
    desk = SteeringDesk(missions, lambda: None, cast("Any", None), cast("Any", None))
    with pytest.raises(SteeringError, match=said):
        await desk.take(Steer("hold"))
