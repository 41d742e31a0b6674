import random
from collections import defaultdict
from collections.abc import AsyncIterator, Mapping

import msgspec
import pytest
from models import built_bundle, engine_of, simulated
from places import DATA
from scripted_missions import run_mission

from aos_protocol.messages import Activate, BeliefSummary, Outcome
from aos_runtime.disk.journal import JournalRow
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.models.past import Evidence, Past, replayed, updated
from aos_solver.mission.records.memory import folded
from aos_solver.mission.rules.endings import MissionLimits

State = tuple[str, bool]
"""The charge, and whether the robot is there."""
Belief = dict[State, float]

BATTERY = DATA / "bundles" / "battery"


@pytest.fixture
async def battery() -> BuiltModel:
    return await built_bundle(BATTERY)


@pytest.fixture
async def engine(battery: BuiltModel) -> AsyncIterator[Engine]:
    async with engine_of(battery) as running:
        yield running


# --- the truth, by hand ---


def after_step(belief: Belief, skill: str, response: str) -> Belief:
    """The documents' step and Bayes' rule for its response; a state that has ended stays as it is."""
    after: dict[State, float] = defaultdict(float)
    for (charge, is_there), weight in belief.items():
        sinks = {"Full": {"Full": 0.7, "Half": 0.3}, "Half": {"Half": 0.7, "Low": 0.3}}.get(
            charge, {charge: 1.0}
        )
        for next_charge, of_charge in sinks.items():
            arrives = 0.1 if next_charge == "Low" else 0.3
            for next_there, of_drive in (
                ((True, arrives), (False, 1 - arrives)) if skill == "go" else ((None, 1.0),)
            ):
                told = "DefaultObservation" if next_there is None else "arrived" if next_there else "halted"
                if told != response:
                    continue
                chance = weight * of_charge * of_drive
                if is_there:
                    after[charge, True] += chance
                else:
                    after["Full" if skill == "charge" else next_charge, bool(next_there)] += chance
    return normalized(after)


def after_monitor(belief: Belief, response: str) -> Belief:
    low = {"Full": 0.05, "Half": 0.05, "Low": 0.9}
    return normalized(
        {
            state: weight * (low[state[0]] if response == "low" else 1 - low[state[0]])
            for state, weight in belief.items()
        }
    )


def normalized(belief: Mapping[State, float]) -> Belief:
    total = sum(belief.values())
    return {state: weight / total for state, weight in belief.items() if weight > 0}


def marginals(summary: BeliefSummary) -> dict[str, dict[str, float]]:
    return {marginal.variable: marginal.values for marginal in summary.marginals}


def assert_is(summary: BeliefSummary, belief: Belief, *, within: float = 1e-12):
    charges: dict[str, float] = defaultdict(float)
    for (charge, _), weight in belief.items():
        charges[charge] += weight
    told = marginals(summary)["charge"]
    for charge in ("Full", "Half", "Low"):
        assert told.get(charge, 0.0) == pytest.approx(charges[charge], abs=within)
    there = sum(weight for (_, is_there), weight in belief.items() if is_there)
    assert summary.goal_probability == pytest.approx(there, abs=within)


# --- beliefs ---


async def test_the_belief_is_the_posterior_of_the_step_and_of_what_the_monitor_says(engine: Engine):
    draws = random.Random(6)
    for _ in range(20):
        truth: Belief = {("Full", False): 1.0}
        await engine.reset_belief()
        for _ in range(6):
            skill = draws.choice(("go", "go", "charge"))
            response = "halted" if skill == "go" else "DefaultObservation"
            said = draws.choice(("low", "fine"))
            update = await updated(engine, Evidence(skill, skill, response, monitors={"battery": said}), 0.01)
            truth = after_monitor(after_step(truth, skill, response), said)
            assert_is(update.summary, truth)


async def test_a_state_that_has_ended_is_monitored_and_stays_as_it_is(engine: Engine):
    truth = after_monitor(after_step({("Full", False): 1.0}, "go", "arrived"), "low")
    evidence = Evidence("go", "go", "arrived", monitors={"battery": "low"})
    assert_is((await updated(engine, evidence, 0.01)).summary, truth)


async def test_the_monitor_counts_also_after_a_skill_that_did_not_run_or_may_have_run(engine: Engine):
    await updated(engine, Evidence("go", "go", "halted"), 0.01)
    before = after_step({("Full", False): 1.0}, "go", "halted")
    failed = Evidence("go", "go", ran_probability=0.0, monitors={"battery": "low"})
    assert_is((await updated(engine, failed, 0.01)).summary, after_monitor(before, "low"))
    lost = Evidence("charge", "charge", ran_probability=0.5, monitors={"battery": "fine"})
    ran = after_step(after_monitor(before, "low"), "charge", "DefaultObservation")
    mixed: Belief = defaultdict(float)
    for belief in (ran, after_monitor(before, "low")):
        for state, weight in belief.items():
            mixed[state] += weight / 2
    assert_is((await updated(engine, lost, 0.01)).summary, after_monitor(mixed, "fine"))


async def test_a_drawn_belief_agrees_with_the_exact_one(engine: Engine):
    await engine.draw_belief()
    truth: Belief = {("Full", False): 1.0}
    for said in ("fine", "low", "low", "fine"):
        truth = after_monitor(after_step(truth, "go", "halted"), said)
        update = await updated(engine, Evidence("go", "go", "halted", monitors={"battery": said}), 0.01)
        assert_is(update.summary, truth, within=0.05)


async def test_what_the_model_does_not_know_says_nothing_and_is_told(engine: Engine):
    evidence = Evidence("go", "go", "halted", monitors={"battery": "empty", "person": "near"})
    update = await updated(engine, evidence, 0.01)
    assert_is(update.summary, after_step({("Full", False): 1.0}, "go", "halted"))
    assert update.remark == (
        "the model has no monitor battery that says empty; the model has no monitor person that says near"
    )


async def test_nobody_plans_with_a_monitor(engine: Engine):
    assert [action.name for action in engine.description.actions] == ["charge", "go"]
    assert engine.description.monitors == ("battery",)


# --- missions ---


def robot(request: Activate) -> Outcome:
    said = "low" if request.id.step % 2 else "fine"
    response = "halted" if request.skill == "go" else "DefaultObservation"
    return Outcome(request.id, request.skill, "observed", response, monitors={"battery": said})


async def test_the_journal_gives_the_belief_again(battery: BuiltModel):
    state, around = await run_mission(
        battery, robot, limits=MissionLimits(step_limit=5), search=Search(simulations=200, seed=1)
    )
    assert state.ending == "step_limit"
    truth: Belief = {("Full", False): 1.0}
    for record in around.outcomes:
        assert record.outcome is not None
        truth = after_step(truth, record.skill, record.outcome.response)
        truth = after_monitor(truth, record.outcome.monitors["battery"])
        assert_is(record.belief, truth)
    rows = [
        JournalRow(number, 0, kind, msgspec.json.encode(payload))
        for number, (kind, payload) in enumerate(around.journalled, start=1)
    ]
    past = Past()
    past.steps += [
        Evidence(
            step.decision.action, step.decision.skill, step.outcome.response, monitors=step.outcome.monitors
        )
        for step in folded(rows).steps
    ]
    async with engine_of(battery) as again:
        updates = [update async for update in replayed(again, past)]
    assert [update.summary for update in updates] == [record.belief for record in around.outcomes]


async def test_a_simulated_world_says_what_the_model_says_of_its_state(battery: BuiltModel):
    async with engine_of(battery) as engine:
        said = []
        for seed in range(1, 201):
            await engine.reset_world(seed)
            await engine.step_world(0)
            said.append((await engine.monitor_world())["battery"])
        # `charge` fills the battery, so that `low` is said by mistake: once in twenty.
        assert 1 <= said.count("low") <= 22
        run = await simulated(engine, 200, seed=3, step_limit=10)
    assert len(run.monitors) == run.steps > 0
    assert {response for told in run.monitors for response in told.values()} <= {"low", "fine"}
