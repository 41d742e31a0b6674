"""The mission loop with a real engine, and a robot that the test scripts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from models import built_bundle, engine_of

from aos_protocol.messages import Activate, DecisionRecord, Fault, Message, MissionState, Outcome
from aos_runtime.clock import SystemClock
from aos_solver.building.build import BuiltModel
from aos_solver.endings import MissionLimits
from aos_solver.hot_plug import RunningModel
from aos_solver.mission import MAX_LOST_ACTIVATIONS, Mission
from aos_solver.search import Search

Robot = Callable[[Activate], Outcome]


class Surroundings:
    """What the loop is given: a journal that the test can read, and a robot."""

    clock = SystemClock()

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.journalled: list[tuple[str, Message]] = []
        self.records: list[DecisionRecord] = []

    def journal(self, kind: str, payload: Message) -> None:
        self.journalled.append((kind, payload))

    def publish_record(self, record: DecisionRecord) -> None:
        self.records.append(record)

    def publish_state(self, state: MissionState) -> None:
        """The mission keeps its own."""

    async def activate(self, request: Activate) -> Outcome:
        assert self.journalled[-1] == ("intended", request)
        return self._robot(request)

    async def newest_model(self, running: RunningModel) -> RunningModel:
        return running


def observed(request: Activate, response: str) -> Outcome:
    return Outcome(request.id, request.skill, "observed", response)


def timed_out(request: Activate) -> Outcome:
    return Outcome(
        request.id, request.skill, "timed_out", fault=Fault("AOS503", "the skill took longer than it may")
    )


@pytest.fixture
async def finer(bundles: Path, cache_dir: Path) -> BuiltModel:
    return await built_bundle(bundles / "armadillo-finer", cache_dir)


async def run_mission(
    built: BuiltModel, robot: Robot, *, step_limit: int = 30
) -> tuple[MissionState, Surroundings]:
    around = Surroundings(robot)
    limits = MissionLimits(step_limit=step_limit)
    search = Search(simulations=100_000, seed=1)
    async with engine_of(built) as engine:
        model = RunningModel(1, built, engine)
        mission = Mission("m", 1, model, limits, search, around, activation_timeout_s=1.0)
        return await mission.run(), around


async def test_after_a_lost_activation_the_belief_is_that_it_ran_or_did_not(finer: BuiltModel) -> None:
    _, around = await run_mission(finer, timed_out, step_limit=1)
    decision, outcome = around.records
    assert decision.action == "navigate(destination=easy_table)"
    assert outcome.outcome is not None
    assert outcome.outcome.status == "timed_out"
    places = next(m.values for m in outcome.belief.marginals if m.variable == "robot_at")
    assert places["EasyTable"] == pytest.approx(0.5)
    assert not outcome.is_impossible
    assert [kind for kind, _ in around.journalled if kind in ("intended", "outcome")] == [
        "intended",
        "outcome",
    ]


async def test_a_robot_that_never_answers_ends_the_mission_with_what_to_look_at(finer: BuiltModel) -> None:
    state, around = await run_mission(finer, timed_out)
    assert (state.phase, state.ending) == ("ended", "fault")
    assert "AOS503" in state.remark
    assert "skill's log" in state.remark
    assert sum(kind == "intended" for kind, _ in around.journalled) == MAX_LOST_ACTIVATIONS


async def test_a_mission_goes_on_after_one_lost_activation(finer: BuiltModel) -> None:
    answers = {
        "navigate": "arrived",
        "pick": "pick_succeeded",
        "observe_holding": "holding",
        "observe_arm_outstretched": "not_outstretched",
        "serve": "delivered",
    }

    def robot(request: Activate) -> Outcome:
        return timed_out(request) if request.id.step == 1 else observed(request, answers[request.skill])

    state, around = await run_mission(finer, robot)
    assert state.ending == "goal"
    assert all(each.planner and each.why and each.threads == 1 for each in around.records)
    statuses = [record.outcome.status for record in around.records if record.outcome]
    assert statuses[0] == "timed_out"
    assert set(statuses[1:]) == {"observed"}


async def test_an_activation_that_failed_for_good_ends_the_mission_as_a_fault(finer: BuiltModel) -> None:
    def robot(request: Activate) -> Outcome:
        return Outcome(
            request.id, request.skill, "failed", fault=Fault("AOS401", "pick.am:7: a division by zero")
        )

    state, _ = await run_mission(finer, robot)
    assert state.ending == "fault"
    assert "AOS401: pick.am:7: a division by zero" in state.remark
