import math
from collections.abc import Mapping

import numpy as np
import pytest
from models import engine_of_text, simulated
from numpy.typing import NDArray

from aos_protocol.errors import ModelError
from aos_solver.child.engine import Engine

ENVIRONMENT = """project: gauge
horizon: 5
discount: 0.9

state_variable: int level

state_variable: double place

initial_belief:
{belief}

reward_code:
__reward = 0;
"""

THREE_LEVELS = "state.level = AOSUtils::SampleDiscrete(vector<double>{0.5, 0.3, 0.2});"
PRIOR = (0.5, 0.3, 0.2)


def documents(dynamic_model: str, belief: str = THREE_LEVELS) -> dict[str, str]:
    return gauge({"look": dynamic_model}) | {"gauge.ef": ENVIRONMENT.format(belief=belief)}


def gauge(skills: Mapping[str, str]) -> dict[str, str]:
    """The documents with these skills, each with its dynamic model: one model is compiled."""
    files = {f"{skill}.sd": f"project: gauge\n\ndynamic_model:\n{code}" for skill, code in skills.items()}
    return {"gauge.ef": ENVIRONMENT.format(belief=THREE_LEVELS), **files}


def normal(value: float, mean: float, deviation: float) -> float:
    return math.exp(-0.5 * ((value - mean) / deviation) ** 2) / (deviation * math.sqrt(2 * math.pi))


def posterior(prior: Mapping[int, float], likelihood: Mapping[int, float]) -> tuple[dict[int, float], float]:
    joint = {level: probability * likelihood[level] for level, probability in prior.items()}
    density = sum(joint.values())
    return {level: weight / density for level, weight in joint.items()}, density


async def levels(engine: Engine) -> dict[int, float]:
    summary = await engine.summary()
    (values,) = (marginal.values for marginal in summary.marginals if marginal.variable == "level")
    return {int(level): probability for level, probability in values.items()}


EVERY_DRAW = """
enum Shade { Dark, Dim, Bright };
if (AOS.Bernoulli(0.1 * state.level)) {
    __moduleResponse = blind;
} else {
    __moduleResponse = read;
    __observed.warmth = AOS.SampleUniform(state.level - 1.0, 2.0 * state.level + 1.0);
    __observed.shade = AOS.SampleDiscrete(Shade, {1.0, 1.0 + state.level, 2.0});
    __observed.kind = AOSUtils::SampleDiscrete(vector<double>{0.2, 0.1 * state.level});
    if (AOS.Bernoulli(0.5)) __observed.beeps = AOS.Bernoulli(0.3 + 0.2 * state.level);
}
"""
EXACT = gauge(
    {
        "plumb": (
            "__moduleResponse = read;\n"
            "__observed.depth = AOS.SampleNormal(2.0 * state.level, 1.0 + 0.5 * state.level);\n"
        ),
        "feel": EVERY_DRAW,
        "scan": (
            "__moduleResponse = read;\n"
            "for (int i = 3; i >= 0; i--) __observed.beams[i] = AOS.SampleNormal(state.level * i, 1.5);\n"
            "for (int i = 0; i < 1 + state.level; i++) __observed.hits.push_back(AOS.Bernoulli(0.4));\n"
        ),
        "sweep": (
            "__moduleResponse = read;\n"
            "for (int i = 0; i < 100; i++) __observed.beams[i] = AOS.SampleNormal(state.level, 0.5);\n"
        ),
        "poke": (
            "if (state.level == 2) {\n    __moduleResponse = blind;\n    return;\n}\n"
            "__moduleResponse = read;\n"
            "__observed.depth = AOS.SampleUniform(state.level, state.level + 0.5);\n"
        ),
    }
)
"""Skills whose numbers leave beliefs exact."""


async def test_a_sequence_of_normal_readings_gives_the_posterior_of_bayes_rule():
    """The noise depends on the state, so that both the mean and the deviation tell."""
    async with engine_of_text(EXACT) as engine:
        belief = dict(enumerate(PRIOR))
        for depth in (1.3, -0.4, 2.9, 3.3):
            likelihood = {level: normal(depth, 2.0 * level, 1.0 + 0.5 * level) for level in belief}
            belief, density = posterior(belief, likelihood)
            update = await engine.update("plumb", "read", numbers={"depth": depth})
            assert update.summary.is_exact
            assert update.probability == pytest.approx(density, rel=1e-9)
            assert update.surprise == pytest.approx(-math.log(density), rel=1e-9)
            assert await levels(engine) == pytest.approx(belief, abs=1e-9)


@pytest.mark.parametrize(("kind", "beeps"), [(0, True), (1, False), (-1, None)])
async def test_several_numbers_and_a_response_count_together(kind, beeps):
    """Discrete draws by their probability; also whether a number is reported tells something."""
    likelihood = {}
    for level in range(3):
        chance = 1 - 0.1 * level
        warmth = 1 / (level + 2) if level - 1 <= 0.7 <= 2 * level + 1 else 0.0
        shade = (1 + level) / (4 + level)
        kinds = {0: 0.2, 1: 0.1 * level, -1: 0.8 - 0.1 * level}
        beep = {True: 0.3 + 0.2 * level, False: 0.7 - 0.2 * level, None: 1.0}
        likelihood[level] = chance * warmth * shade * kinds[kind] * 0.5 * beep[beeps]
    expected, density = posterior(dict(enumerate(PRIOR)), likelihood)
    async with engine_of_text(EXACT) as engine:
        numbers = {"warmth": 0.7, "shade": 1, "kind": kind, "beeps": beeps}
        update = await engine.update("feel", "read", numbers=numbers)
        assert update.probability == pytest.approx(density, rel=1e-9)
        assert await levels(engine) == pytest.approx({k: v for k, v in expected.items() if v}, abs=1e-9)
        feel = [action.name for action in engine.description.actions].index("feel")
        (prediction,) = [response.probability for response in (await engine.predict(feel)).predicted[:1]]
        assert prediction == pytest.approx(sum(p * (1 - 0.1 * level) for level, p in expected.items()))


async def test_arrays_count_by_element_whatever_the_order_of_their_reports():
    beams = [0.4, 1.7, 1.2, 4.4]
    async with engine_of_text(EXACT) as engine:
        update = await engine.update("scan", "read", numbers={"beams": beams, "hits": [True, False]})
        # Only at level 1 there are two hits.
        density = math.prod(normal(beam, i, 1.5) for i, beam in enumerate(beams)) * 0.4 * 0.6 * PRIOR[1]
        assert update.probability == pytest.approx(density, rel=1e-9)
        assert await levels(engine) == pytest.approx({1: 1.0})


async def test_a_hundred_numbers_that_hardly_fit_have_a_posterior_all_the_same():
    """Their density is far below what a double can hold."""
    beams = [8.0 + 0.01 * i for i in range(100)]
    logs = [
        sum(-0.5 * ((beam - level) / 0.5) ** 2 - math.log(0.5 * math.sqrt(2 * math.pi)) for beam in beams)
        + math.log(PRIOR[level])
        for level in range(3)
    ]
    async with engine_of_text(EXACT) as engine:
        update = await engine.update("sweep", "read", numbers={"beams": beams})
        total = max(logs) + math.log(sum(math.exp(log - max(logs)) for log in logs))
        assert total < -7000
        assert update.log_probability == pytest.approx(total, rel=1e-9)
        assert await levels(engine) == pytest.approx({2: 1.0})


async def test_a_drifting_place_is_followed_as_by_a_kalman_filter():
    """Both the state and what is reported are continuous, so particles are weighed by the density."""
    files = documents(
        "state__.place = state.place + AOS.SampleNormal(0.3, 0.4);\n"
        "__moduleResponse = read;\n"
        "__observed.sight = AOS.SampleNormal(state__.place, 0.5);\n",
        belief="state.place = AOS.SampleNormal(0, 1);",
    )
    async with engine_of_text(files) as engine:
        (place,) = (each for each in (await engine.summary()).marginals if each.variable == "place")
        assert place.quantiles == pytest.approx((-1.65, -0.67, 0.0, 0.67, 1.65), abs=0.15)
        mean, variance = 0.0, 1.0
        expected = log_probability = 0.0
        for sight in (0.1, 0.9, 0.5, 1.4, 2.0, 1.6, 3.4, 3.0, 3.9, 3.6):
            mean, variance = mean + 0.3, variance + 0.16
            expected += math.log(normal(sight, mean, math.sqrt(variance + 0.25)))
            gain = variance / (variance + 0.25)
            mean, variance = mean + gain * (sight - mean), (1 - gain) * variance
            update = await engine.update("look", "read", numbers={"sight": sight})
            log_probability += update.log_probability
            weights, places = await places_of(engine)
            assert update.summary.effective_states >= 100
            assert np.average(places, weights=weights) == pytest.approx(mean, abs=0.08)
            spread = np.average((places - mean) ** 2, weights=weights)
            assert spread == pytest.approx(variance, rel=0.25)
        assert not update.summary.is_exact
        assert log_probability == pytest.approx(expected, abs=0.3)


async def places_of(engine: Engine) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The weights and the places of a belief: the first number of a saved state is the bits of its place."""
    belief = await engine.export_belief()
    weights = np.array([weight for weight, _ in belief.particles])
    bits = np.array([int(state.split()[0]) for _, state in belief.particles], dtype=np.int64)
    return weights, bits.view(np.float64)


async def test_other_numbers_than_the_model_reports_leave_the_response_alone():
    async with engine_of_text(EXACT) as engine:
        missing = await engine.update("poke", "read", {"depth": "null"}, {})
        assert not missing.is_impossible
        assert missing.remark == (
            "the numbers of poke do not count (depth = null): the model reports others with the response read"
        )
        assert missing.probability == pytest.approx(0.8)
        assert (await engine.update("poke", "read")).remark == ""  # Supposed, as `aos why` does.
        await engine.reset_belief()
        await engine.update("poke", "read", numbers={})
        assert await levels(engine) == pytest.approx({0: 5 / 8, 1: 3 / 8})
        impossible = await engine.update("poke", "read", numbers={"depth": 0.7})
        assert (impossible.is_impossible, impossible.remark) == (True, "")
        await engine.reset_belief()
        needless = await engine.update("poke", "blind", numbers={"depth": 0.7})
        assert "depth = 0.7" in needless.remark
        assert await levels(engine) == pytest.approx({2: 1.0})


DEPTH_AND_BEAM = documents(
    "__moduleResponse = read;\n__observed.depth = AOS.SampleNormal(3.0 * state.level, 1.0);\n"
    "__observed.beams.push_back(AOS.SampleUniform(0, 1));\n"
)


async def test_simulated_worlds_give_numbers_that_their_belief_learns_from():
    async with engine_of_text(DEPTH_AND_BEAM) as engine:
        limits = {"goal_probability": 0.9, "step_limit": 12}
        run, again = [await simulated(engine, 100, seed=4, **limits) for _ in range(2)]
        assert run == again
        assert [sorted(numbers) for numbers in run.numbers] == [["beams", "depth"]] * 12
        assert max((await levels(engine)).values()) > 0.999


FAULTS = {
    "depth": (
        "__observed.depth = AOS.SampleNormal(0, state.level);",
        "the deviation of a reported number",
        6,
    ),
    "again": (
        "__observed.depth = AOS.SampleNormal(0, 1);\nif (state.level == 1) "
        "__observed.depth = AOS.SampleNormal(0, 1);",
        "reported twice",
        7,
    ),
    "below": ("__observed.beams[state.level - 1] = AOS.Bernoulli(0.5);", "no element -1", 6),
}
"""Skills with a statement, what is wrong with it, and its line."""
FAULTY = gauge(
    {skill: f"__moduleResponse = read;\n\n{statement}\n" for skill, (statement, _, _) in FAULTS.items()}
)


@pytest.mark.parametrize("skill", FAULTS)
async def test_a_report_without_a_density_is_a_fault_at_its_statement(skill):
    _, why, line = FAULTS[skill]
    numbers = {"beams": [True]} if skill == "below" else {"depth": 0.5}
    async with engine_of_text(FAULTY) as engine:
        with pytest.raises(ModelError, match=why) as raised:
            await engine.update(skill, "read", numbers=numbers)
    assert raised.value.code == "AOS215"
    (diagnostic,) = raised.value.diagnostics
    assert (diagnostic.span.file, diagnostic.span.line) == (f"{skill}.sd", line)


async def test_what_enumerates_observations_says_that_it_cannot():
    async with engine_of_text(DEPTH_AND_BEAM) as engine:
        with pytest.raises(ModelError, match="what is observed are numbers") as raised:
            await engine.exact_values()
        assert raised.value.code == "AOS220"
        with pytest.raises(ModelError, match="what is observed are numbers"):
            await engine.list_states(1000)


async def test_numbers_of_too_many_combinations_are_searched_in_beliefs():
    files = documents(
        "__moduleResponse = read;\n"
        "for (int i = 0; i < 9; i++) __observed.beams[i] = AOS.SampleNormal(state.level, 1.5);\n"
    )
    async with engine_of_text(files) as engine:
        plan = await engine.plan(seed=1, simulations=200, planner="auto")
        assert plan.planner == "belief-tree"
        assert "SARSOP cannot be used: 9 numbers are observed at once" in plan.why


async def test_numbers_of_many_values_have_the_quantiles_of_their_distribution():
    """The place that drifts has those of the normal distribution, for its belief is drawn."""
    look = "__moduleResponse = read;\n"
    tenths = (
        "state.level = AOSUtils::SampleDiscrete(vector<double>(20, 0.05)); state.place = state.level / 10.0;"
    )
    async with engine_of_text(documents(look, belief=tenths)) as engine:
        found = {each.variable: each.quantiles for each in (await engine.summary()).marginals}
        assert found == {"level": (0, 4, 9, 14, 18), "place": (0.0, 0.4, 0.9, 1.4, 1.8)}
    few = "state.level = AOSUtils::SampleDiscrete(vector<double>(9, 1.0)); state.place = state.level % 8;"
    async with engine_of_text(documents(look, belief=few)) as engine:
        assert [each.quantiles for each in (await engine.summary()).marginals] == [(), ()]
