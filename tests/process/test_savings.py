"""Decisions where nothing is rewarded and what is neglected costs: what saves most against a rest."""

from pathlib import Path

from models import built_text, engine_of, engine_of_text
from wide.cleaning import cleaning
from wide.greenhouse import greenhouse

from aos_solver.child.engine import Restriction
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

_SIMULATIONS = 500


async def test_plants_are_watered_the_tank_is_refilled_and_a_value_is_what_missions_return(cache_dir: Path):
    """Over 60 steps rests return -82 on average, and a round trip by hand -17."""
    built = await built_text(greenhouse(5), cache_dir)
    async with engine_of(built) as engine, engine_of(built) as other, engine_of(built) as third:
        plan = await engine.plan(simulations=_SIMULATIONS, seed=1, planner="auto")
        assert plan.planner == "savings"
        same = await other.plan(simulations=_SIMULATIONS, seed=1, planner="auto")
        assert same.actions == plan.actions
        # An action that is barred saves nothing.
        within = Restriction(barred=[plan.index])
        barred = await third.plan(simulations=_SIMULATIONS, seed=1, planner="auto", within=within)
        assert (barred.planner, barred.index == plan.index) == ("savings", False)
        limits = MissionLimits(goal_probability=1, step_limit=60)
        run = await simulate_mission(engine, Search(simulations=_SIMULATIONS, seed=1), limits)
    assert sum(action.startswith("water") for action in run.actions) >= 12
    assert sum(action == "refill" for action in run.actions) >= 2
    told = plan.actions[plan.index]
    assert run.discounted_return > -30
    assert abs(told.q - run.discounted_return) < 3 * told.stderr


async def test_a_robot_charges_and_empties_its_bin_although_that_saves_nothing_at_once(cache_dir: Path):
    async with engine_of_text(cleaning(7), cache_dir) as engine:
        search = Search(simulations=_SIMULATIONS, seed=1)
        run = await simulate_mission(engine, search, MissionLimits(goal_probability=1, step_limit=15))
    assert sum(action == "clean" for action in run.actions) >= 4
    assert {"charge", "empty_bin"} <= set(run.actions)
