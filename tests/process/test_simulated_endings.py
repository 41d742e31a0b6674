import json

import pytest
from commands import aos
from models import engine_of_text, simulated
from texts import write_texts

from aos_solver.mission.rules.endings import Ending

SERVED = 0.92
"""The belief holds the goal for this sure where nothing is seen: surer than the 0.9 that end a mission."""

TABLE = {
    "table.ef": """project: table
horizon: 3
discount: 1
define_type: Cup
enum_members: Held, Served, Spilt, Kept
state_variable: Cup cup
code:
state.cup = Held;
reward_code:
if (state.cup == Served) { __reward = 10; __isGoalState = true; }
reward_code:
if (state.cup == Spilt) { __reward = -10; __isFailureState = true; }
reward_code:
if (state.cup == Kept) __isGoalState = true;
""",
    "serve.sd": f"""project: table
dynamic_model:
state__.cup = AOS.Bernoulli({SERVED}) ? Served : Spilt;
__moduleResponse = done;
""",
    "keep.sd": """project: table
dynamic_model:
state__.cup = Kept;
__reward = -1;
""",
}
LIMITS = {"goal_probability": 0.9, "step_limit": 3}


async def test_a_failure_that_the_belief_takes_for_the_goal_is_told():
    async with engine_of_text(TABLE) as engine:
        runs = [await simulated(engine, 200, seed=seed, **LIMITS) for seed in range(1, 121)]
    assert {run.ending for run in runs} == {run.believed_ending for run in runs} == {Ending.GOAL}
    spilt = [run for run in runs if run.world_ending is Ending.FAILURE]
    assert all(run.world_ending in (Ending.GOAL, Ending.FAILURE) for run in runs)
    assert {run.total for run in spilt} == {-10.0}
    # Of 120 missions 9.6 fail on the average; the binomial's standard deviation is 3.
    assert 1 <= len(spilt) <= 20


async def test_a_belief_tells_each_ending_apart():
    async with engine_of_text(TABLE) as engine:
        served = (await engine.update("serve", "done")).summary
        await engine.reset_belief()
        kept = (await engine.update("keep", "DefaultObservation")).summary
    assert served.goal_probability == pytest.approx(SERVED)
    assert served.failure_probability == pytest.approx(1 - SERVED)
    assert served.over_probability == 0
    assert (kept.goal_probability, kept.failure_probability, kept.over_probability) == (0, 0, 1)


async def test_a_mission_can_be_over_without_a_goal_or_a_failure():
    keep = {name: text for name, text in TABLE.items() if not name.startswith("serve")}
    async with engine_of_text(keep) as engine:
        run = await simulated(engine, 100, **LIMITS)
    assert (run.ending, run.world_ending, run.believed_ending) == (Ending.OVER,) * 3
    assert run.total == -1


def test_goals_are_counted_by_the_world(tmp_path):
    write_texts(TABLE, tmp_path)
    command = ["simulate", str(tmp_path), "--runs", "40", "--simulations", "100"]
    done = aos(*command, "--json")
    assert done.exit_code == 0, done.output
    campaign = json.loads(done.stdout)
    endings = [run["world_ending"] for run in campaign["runs"]]
    summary = campaign["summary"]
    assert summary["believed_goal_rate"] == 1
    assert summary["goal_rate"] == endings.count("goal") / 40 < 1
    assert summary["failure_rate"] == endings.count("failure") / 40
    assert summary["over_rate"] == 0
    output = aos(*command).stdout
    assert "believed in 100%" in output
