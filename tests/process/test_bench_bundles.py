import itertools
import math
import random

import pytest
from models import engine_of_bundle
from places import BUNDLES
from reference_problems import MODELS, expected_reward, initial_belief, observed

from aos_lab.bench.problems import problems_named
from aos_lab.bench.rocksamples import bundle
from aos_language.load import load_bundle

WALKS = 6
STEPS_OF_A_WALK = 15
NORMAL = ("laser-normal", "lightdark-normal")
"""Observations are numbers here."""


@pytest.mark.parametrize("problem", MODELS)
async def test_rewards_observations_and_beliefs_are_the_literatures(problem):
    model = MODELS[problem]
    draws = random.Random(f"walks of {problem}")
    async with engine_of_bundle(BUNDLES / "bench" / problem) as engine:
        assert [action.name for action in engine.description.actions] == sorted(model.actions)
        for walk in range(WALKS):
            belief = initial_belief(model)
            await engine.reset_belief()
            await engine.reset_world(seed=walk)
            ending = ""
            for _ in range(STEPS_OF_A_WALK):
                for value in (await engine.exact_values(horizon=1)).actions:
                    assert value.q == pytest.approx(expected_reward(model, belief, value.action), abs=1e-9)
                index = draws.randrange(len(model.actions))
                action = engine.description.actions[index].name
                step = await engine.step_world(index)
                probability, belief = observed(model, belief, action, step.response)
                update = await engine.update(action, step.response)
                assert update.probability == pytest.approx(probability, abs=1e-9)
                ending = step.ending
                if not belief:
                    break
                entropy = -sum(weight * math.log(weight) for weight in belief.values())
                assert update.summary.entropy == pytest.approx(entropy, abs=1e-6)
            assert (ending == "goal") == (not belief)


async def test_light_and_dark_weigh_places_by_their_noise():
    """The robot starts in one of nine cells; after a step north it measures its place."""
    east_m, north_m = 2.9, 1.4
    weights = {}
    for x, y in itertools.product((1, 2, 3), (2, 3, 4)):
        deviation = 0.4 + 0.45 * (9 - y)
        squares = ((east_m - x) / deviation) ** 2 + ((north_m - y) / deviation) ** 2
        weights[x, y] = math.exp(-squares / 2) / (2 * math.pi * deviation**2) / 9
    density = sum(weights.values())
    async with engine_of_bundle(BUNDLES / "bench" / "lightdark-normal") as engine:
        numbers = {"east_m": east_m, "north_m": north_m}
        update = await engine.update("move(direction=north)", "moved", numbers=numbers)
    assert update.probability == pytest.approx(density, rel=1e-9)
    (rows,) = (marginal.values for marginal in update.summary.marginals if marginal.variable == "y")
    for y in (2, 3, 4):
        weight = sum(weights[x, y] for x in (1, 2, 3))
        assert rows[str(y)] == pytest.approx(weight / density, abs=1e-9)


def test_the_kept_rocksample_is_as_its_layout_says():
    kept = BUNDLES / "bench" / "rocksample-7-8"
    assert bundle("rocksample-7-8") == {path.name: path.read_text() for path in kept.iterdir()}


@pytest.mark.parametrize("problem", [*MODELS, "rocksample-11-11", "rocksample-15-15", "pocman", *NORMAL])
def test_the_benchmark_bundles_have_no_mistakes(problem):
    (known,) = problems_named([problem])
    loaded = load_bundle(known.bundle)
    assert loaded.project is not None
    # Tasks that go on for ever have no goal.
    assert {finding.code for finding in loaded.diagnostics} <= {"AOS139"}
