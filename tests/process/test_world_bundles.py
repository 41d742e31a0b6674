"""The decisions by the documents of the simulated worlds: the claims of the paper, and what brute force
says."""

import itertools
import math
import random
from functools import cache

import pytest
from models import built_bundles, engine_of, engine_of_bundle
from places import BUNDLES, DEPLOY

from aos_skills.pybullet.world_file import load_world_file
from aos_skills.pybullet.worlds.tictactoe.rules import EMPTY_BOARD, best_moves, empty_cells, is_over, marked
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.simulation import simulate_mission

Point = tuple[float, float]
TO_EASY_TABLE = "navigate(destination=easy_table)"
SENSING = ("observe_holding", "observe_arm_outstretched")


@pytest.mark.parametrize(
    ("names", "horizon", "first"),
    [
        (("armadillo-finer", "armadillo-rough"), None, "pick"),
        (("armadillo-finer",), None, TO_EASY_TABLE),
        (("armadillo-finer", "armadillo-finer-enhanced", "armadillo-rough-enhanced"), 8, "pick"),
        (("armadillo-finer", "armadillo-finer-enhanced"), 8, TO_EASY_TABLE),
    ],
)
async def test_without_sensing_the_rough_pick_comes_first_and_the_finer_one_at_the_easy_table(
    names, horizon, first
):
    async with engine_of(await built_bundles([BUNDLES / name for name in names], SENSING)) as engine:
        values = sorted((await engine.exact_values(horizon)).actions, key=lambda value: -value.q)
    assert values[0].action == first
    assert values[0].q > values[1].q + 1


async def test_the_blind_robot_serves_and_goes_back_to_the_tables():
    both = [BUNDLES / name for name in ("armadillo-finer", "armadillo-rough")]
    async with engine_of(await built_bundles(both, SENSING)) as engine:
        await engine.reset_belief()
        for action, response in (
            ("pick", "pick_succeeded"),
            ("navigate(destination=corridor)", "arrived"),
            ("serve", "delivered"),
            (TO_EASY_TABLE, "arrived"),
            ("pick", "pick_succeeded"),
        ):
            plan = await engine.plan(simulations=100_000, seed=1, planner="auto")
            assert plan.best.action == action
            await engine.update(action, response)


async def test_the_turtlebot_takes_the_shortest_of_all_tours():
    room = load_world_file(DEPLOY / "worlds/turtlebot.yaml").room
    at = {name: (place.x, place.y) for name, place in room.places.items()}
    decided = []
    async with engine_of_bundle(BUNDLES / "turtlebot") as engine:
        await engine.reset_belief()
        for step in range(len(at)):
            plan = await engine.plan(simulations=100_000, seed=step, planner="auto")
            decided.append(plan.best.action.removeprefix("navigate(stop=").removesuffix(")"))
            await engine.update(plan.best.action, "arrived")
    way = [(room.robot.x, room.robot.y), *(at[name] for name in decided)]
    length = sum(math.dist(one, other) for one, other in itertools.pairwise(way))
    assert sorted(decided) == sorted(at)
    assert length == pytest.approx(shortest_tour(way[0], frozenset(at.values())))


@cache
def shortest_tour(start: Point, places: frozenset[Point]) -> float:
    """The least way through all places, by dynamic programming."""
    return min(
        (math.dist(start, place) + shortest_tour(place, places - {place}) for place in places), default=0.0
    )


async def test_the_person_of_the_other_documents_makes_no_mistake():
    both = [BUNDLES / name for name in ("tictactoe", "tictactoe-perfect-person")]
    chance = random.Random(1)
    async with engine_of(await built_bundles(both)) as engine:
        indices = {action.name: index for index, action in enumerate(engine.description.actions)}
        for seed in range(1, 21):
            await engine.reset_world(seed)
            board = EMPTY_BOARD
            while not is_over(board):
                cell = chance.choice(empty_cells(board))
                await engine.step_world(indices[f"draw(cell={cell})"])
                board = marked(board, cell, "O")
                if is_over(board):
                    break
                response = (await engine.step_world(indices["look"])).response
                allowed = [marked(board, move, "X") for move in best_moves(board, "X")]
                assert response in allowed
                board = response


async def test_the_panda_loses_no_game_that_it_begins_though_its_documents_are_wrong_about_the_person():
    perfect = await built_bundles([BUNDLES / name for name in ("tictactoe", "tictactoe-perfect-person")])
    limits = MissionLimits(goal_probability=0.9, step_limit=30)
    async with engine_of_bundle(BUNDLES / "tictactoe") as engine, engine_of(perfect) as world:
        for seed in range(1, 4):
            search = Search(simulations=100_000, seed=seed)
            run = await simulate_mission(engine, search, limits, with_states=True, world=world)
            assert (run.steps, run.total, run.world_ending) == (9, 0.0, "over")
            assert run.states[-1].count("=2") == 4
        alone = await simulate_mission(engine, search, limits)
    assert alone.steps < 9
