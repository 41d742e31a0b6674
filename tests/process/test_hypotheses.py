import os
import signal

import pytest
from models import built_text, engine_of, engine_of_text

from aos_protocol.messages import BeliefSummary
from aos_solver.child.engine import Engine, Restriction

LAMPS = {
    "lamps.ef": """project: lamps
horizon: 5
discount: 0.9
state_variable: bool red
code:
state.red = false;
state_variable: bool blue
code:
state.blue = false;
reward_code:
if (state.red && state.blue) { __reward = 10; __isGoalState = true; }
""",
    **{
        f"{name}.sd": f"project: lamps\ndynamic_model:\nbool works = AOS.Bernoulli(0.5);\n"
        f"state__.{name} = state.{name} || works;\n__moduleResponse = state__.{name} ? done : dark;\n"
        for name in ("red", "blue")
    },
    "press.sd": "project: lamps\ndynamic_model:\nstate__.red = true;\n__moduleResponse = done;\n",
    "check.sd": "project: lamps\ndynamic_model:\n__moduleResponse = state.red ? done : dark;\n",
    "see.sd": """project: lamps
dynamic_model:
__moduleResponse = AOS.Bernoulli(0.8) == state.red ? light : darkness;
""",
}


@pytest.fixture
async def lamps() -> Engine:
    async with engine_of_text(LAMPS) as engine:
        yield engine


def probability(summary: BeliefSummary, variable: str) -> float:
    (marginal,) = (marginal.values for marginal in summary.marginals if marginal.variable == variable)
    return marginal.get("true", 0.0)


async def lost(engine: Engine, action: str, times: int = 1, ran: float = 0.5) -> BeliefSummary:
    for _ in range(times):
        summary = (await engine.update_without_observation(action, ran_probability=ran)).summary
    return summary


async def test_unobserved_ends_in_a_row_have_one_cause(lamps: Engine):
    for count in range(1, 6):
        summary = await lost(lamps, "red")
        assert probability(summary, "red") == pytest.approx(0.5 * (1 - 0.5**count))


async def test_what_is_observed_between_weighs_the_causes(lamps: Engine):
    await lost(lamps, "red")
    summary = (await lamps.update("see", "light")).summary
    # It ran and worked (1/4), it ran and did not work (1/4), or it did not run (1/2).
    assert probability(summary, "red") == pytest.approx(0.25 * 0.8 / (0.25 * 0.8 + 0.75 * 0.2))
    ran_on, ran_off, never = (weight / 0.35 for weight in (0.25 * 0.8, 0.25 * 0.2, 0.5 * 0.2))
    summary = await lost(lamps, "red")
    assert probability(summary, "red") == pytest.approx(ran_on + ran_off / 2)
    assert never == pytest.approx(1 - ran_on - ran_off)


async def test_an_observed_end_closes_the_row_of_its_skill_alone(lamps: Engine):
    await lost(lamps, "red")
    await lost(lamps, "blue")
    await lamps.update("red", "dark")
    summary = await lost(lamps, "red")
    # Dark: it did not work, now or before, so the new row begins with a dark lamp.
    assert probability(summary, "red") == pytest.approx(0.25)
    # The row of the other goes on: it ran twice or never.
    assert probability(await lost(lamps, "blue"), "blue") == pytest.approx(0.5 * 0.75)


async def test_the_cautious_belief_has_nothing_that_was_not_observed(lamps: Engine):
    assert (await lamps.summary()).cautious is None
    await lamps.update("blue", "done")
    summary = await lost(lamps, "red", times=3)
    assert summary.cautious is not None
    assert (summary.goal_probability, summary.cautious.goal_probability) == (pytest.approx(0.4375), 0.0)
    update = await lamps.update("red", "done")
    # 1/2 in the cautious belief, and more in the other: the lamp is on in both.
    assert update.summary.cautious is None
    assert update.probability == pytest.approx(0.4375 + 0.5625 / 2)


async def test_an_end_that_changes_nothing_is_believed_to_have_changed_nothing(lamps: Engine):
    before = await lamps.summary()
    assert await lost(lamps, "see", times=3) == before


async def test_a_report_that_was_nonsense_refutes_nothing(lamps: Engine):
    await lamps.update("red", "done")
    await lost(lamps, "blue", ran=0.999)
    for _ in range(4):
        # A lamp that is on stays on: the model excludes that this is ever reported.
        update = await lamps.update("red", "dark")
        assert update.is_impossible or update.is_excluded
        assert update.summary.cautious is not None
        assert update.summary.cautious.goal_probability == 0


async def test_what_only_the_cautious_belief_explains_is_believed(lamps: Engine):
    summary = await lost(lamps, "press", ran=1.0)
    assert probability(summary, "red") == 1
    update = await lamps.update("check", "dark")
    assert (update.is_impossible, update.is_excluded, update.log_probability) == (False, False, 0.0)
    assert (probability(update.summary, "red"), update.summary.cautious) == (0, None)


async def believed(engine: Engine) -> list[BeliefSummary]:
    summaries = [await engine.summary()]
    summaries.append((await engine.update("see", "light")).summary)
    summaries.append(await lost(engine, "red"))
    summaries.append((await engine.update("blue", "dark")).summary)
    return summaries


async def test_hypotheses_outlive_the_engine(lamps: Engine):
    await lost(lamps, "red")
    await lost(lamps, "blue", times=2)
    wanted = await lamps.export_beliefs()
    assert len(wanted.beliefs) == 5
    assert lamps.pid is not None
    os.kill(lamps.pid, signal.SIGKILL)
    assert await lamps.export_beliefs() == wanted


async def test_hypotheses_move_to_another_engine():
    built = await built_text(LAMPS)
    async with engine_of(built) as old, engine_of(built) as new:
        await lost(old, "red")
        await lost(old, "blue", times=2)
        await new.import_beliefs(await old.export_beliefs())
        assert await new.export_beliefs() == await old.export_beliefs()
        assert await believed(new) == await believed(old)


@pytest.mark.parametrize("cautious", [False, True])
async def test_a_search_may_do_without_a_skill_and_start_from_the_cautious_belief(lamps: Engine, cautious):
    await lamps.update("blue", "done")
    await lost(lamps, "red", ran=0.9)
    everything = await lamps.plan(seed=1, simulations=2000, planner="pomcp")
    within = Restriction(without=["red", "press"], cautious=cautious)
    plan = await lamps.plan(seed=1, simulations=2000, within=within, planner="pomcp")
    assert {action.action for action in plan.actions} == {"blue", "check", "see"}
    assert plan.best.action == lamps.description.actions[plan.index].name
    # Without the red lamp there is nothing to earn.
    assert [action.q for action in plan.actions] == [0.0] * 3
    assert not (await lamps.may_reach_goal(without=["red", "press"], cautious=cautious)).is_reachable
    assert (await lamps.may_reach_goal(cautious=cautious)).is_reachable
    again = await lamps.plan(seed=1, simulations=2000, planner="pomcp")
    assert [action.q for action in again.actions] == [action.q for action in everything.actions]
