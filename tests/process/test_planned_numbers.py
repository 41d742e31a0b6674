import re

import numpy as np
from models import engine_of_text, simulated

from aos_solver.child.engine import Engine, Planner
from aos_solver.mission.rules.endings import Ending

DOORS = """project: doors
horizon: 20
discount: 0.95

define_type: Door
enum_members: Left, Right

state_variable: Door tiger_behind

state_variable: bool is_open

state_variable: bool is_eaten

action_parameter: Door left_door
code:
state.left_door = Left;

action_parameter: Door right_door
code:
state.right_door = Right;

initial_belief:
state.tiger_behind = AOS.Bernoulli(0.5) ? Left : Right;

reward_code:
if (state.is_open) {
    __reward = state.is_eaten ? -100 : 10;
    __isGoalState = true;
}
"""
LISTEN = """project: doors

dynamic_model:
__moduleResponse = read;
__observed.side = AOS.SampleNormal(state.tiger_behind == Right ? 1 : -1, 1.0);
__reward = -1;
"""
OPEN = """project: doors
parameter: Door door

dynamic_model:
state__.is_open = true;
state__.is_eaten = state.tiger_behind == door;
__moduleResponse = read;
"""


def value_of_listening() -> float:
    """Computes the value by iteration over the log-odds of the tiger's place, to which a reading z adds 2
    z."""
    odds = np.linspace(-15, 15, 1501)
    right = 1 / (1 + np.exp(-odds))
    opened = 10 - 110 * np.minimum(right, 1 - right)
    nodes, weights = np.polynomial.hermite_e.hermegauss(60)
    weights = weights / weights.sum()
    value = np.zeros_like(odds)
    for _ in range(20):
        after_right = np.interp(odds[:, None] + 2 * (nodes + 1), odds, value) @ weights
        after_left = np.interp(odds[:, None] + 2 * (nodes - 1), odds, value) @ weights
        listened = -1 + 0.95 * (right * after_right + (1 - right) * after_left)
        value = np.maximum(opened, listened)
    return float(listened[len(odds) // 2])


DOCUMENTS_OF_DOORS = {"doors.ef": DOORS, "listen.sd": LISTEN, "open.sd": OPEN}


async def endings_of_doors(engine: Engine, planner: Planner) -> list[Ending]:
    """Plays 30 missions, all of which begin with listening: a door opened at once earns -45 on average."""
    limits = {"goal_probability": 0.9, "step_limit": 20}
    runs = [await simulated(engine, 2000, seed=seed, planner=planner, **limits) for seed in range(30)]
    assert all(run.actions[0] == "listen" for run in runs)
    return [run.ending for run in runs]


async def test_pomcp_looks_ahead_over_numbers():
    """It listens as long as that is worth it."""
    best = value_of_listening()
    async with engine_of_text(DOCUMENTS_OF_DOORS) as engine:
        plan = await engine.plan(seed=1, simulations=20_000, planner="pomcp")
        assert (plan.planner, plan.best.action) == ("pomcp", "listen")
        # Cells tell less than numbers, so it is worth no more than the best, but for chance.
        assert best - 3.5 < plan.best.q < best + 0.5
        assert (await endings_of_doors(engine, "pomcp")).count(Ending.GOAL) >= 27


async def test_where_states_can_be_listed_point_based_search_tells_numbers_by_cells():
    """The robot can earn what is earned over cells. Cells lose little here; there is no upper bound."""
    best = value_of_listening()
    async with engine_of_text(DOCUMENTS_OF_DOORS) as engine:
        plan = await engine.plan(seed=1, simulations=20_000, planner="auto")
        assert (plan.planner, plan.best.action) == ("sarsop", "listen")
        assert plan.best.at_least is not None
        assert plan.best.at_most is None
        assert 0.95 * best <= plan.best.at_least <= best
        assert abs(plan.best.q - best) <= max(2 * plan.best.stderr, 0.05 * best)
        pattern = r"with 20 decisions to go the belief is worth at least 5\.\d+, telling numbers by \d+ cells"
        assert re.search(pattern, plan.why)
        assert "between" not in plan.why
        assert (await endings_of_doors(engine, "auto")).count(Ending.GOAL) >= 27
