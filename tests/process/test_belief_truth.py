import random
import re
import statistics

import pytest
from models import built_text, engine_of, engine_of_text
from processes import kill_engine

from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.child.engine import Engine


def row_of_bools(name: str, count: int, odds: str) -> str:
    """An environment of `count` bools; bool `i` is true with probability `odds`, each for itself."""
    return f"""project: {name}
horizon: 5
discount: 0.95

state_variable: bool {name} []
code:
state.{name}.assign({count}, false);

initial_belief:
for (int i = 0; i < {count}; i++) state.{name}[i] = AOS.Bernoulli({odds});
"""


def looking_at_one(project: str, count: int, condition: str) -> str:
    return f"""project: {project}
parameter: int number

available_parameters_code:
for (int i = 0; i < {count}; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
__moduleResponse = {condition} ? yes : no;
"""


LAMPS = 18
MANY_STATES = {
    "lamps.ef": row_of_bools("lamps", LAMPS, "0.02 + 0.02 * i"),
    "read.sd": looking_at_one("lamps", LAMPS, "AOS.Bernoulli(state.lamps[number] ? 0.9 : 0.2)"),
}
"""2^18 states, more than a belief holds; each lamp is independent of the others."""


async def test_the_error_of_a_belief_with_too_many_states_is_within_its_bound():
    async with engine_of_text(MANY_STATES) as engine:
        first = await engine.summary()
        update = await engine.update("read(number=9)", "yes")
    assert not first.is_exact
    assert 0 < first.error_bound < 0.1
    assert first.effective_states < first.states <= 100_000
    prior = [0.02 + 0.02 * lamp for lamp in range(LAMPS)]
    assert update.probability == pytest.approx(0.9 * prior[9] + 0.2 * (1 - prior[9]), abs=first.error_bound)
    posterior = [*prior]
    posterior[9] = 0.9 * prior[9] / (0.9 * prior[9] + 0.2 * (1 - prior[9]))
    for lamp, marginal in enumerate(update.summary.marginals):
        assert marginal.values.get("true", 0.0) == pytest.approx(
            posterior[lamp], abs=update.summary.error_bound
        )
    # The light states that are dropped make room for others like them, so the error is far below its bound.
    assert update.summary.marginals[9].values["true"] == pytest.approx(posterior[9], abs=0.005)


CARDS = 28
DEPLETING = {
    "cards.ef": row_of_bools("cards", CARDS, "0.5"),
    "turn.sd": looking_at_one("cards", CARDS, "state.cards[number]"),
}
"""2^28 states, of which each activation rules out half: 5,000 particles last for 12 of 28."""


async def turn(engine: Engine, card: int, hand: list[bool]) -> BeliefUpdate:
    update = await engine.update(f"turn(number={card})", "yes" if hand[card] else "no")
    assert not update.is_impossible, card
    return update


async def turn_and_look(engine: Engine, card: int, hand: list[bool]):
    update = await turn(engine, card, hand)
    marginals = {marginal.variable: marginal.values for marginal in update.summary.marginals}
    assert marginals[f"cards[{card}]"].get("true" if hand[card] else "false", 0.0) > 0.9, card


async def test_particles_outlive_more_observations_than_they_can_tell_apart():
    dice = random.Random(1)
    hand = [dice.random() < 0.5 for _ in range(CARDS)]
    async with engine_of_text(DEPLETING) as engine:
        for card in range(CARDS):
            update = await turn(engine, card, hand)
    moves = r"(\d+) particles were moved (?:once|\d+ times), as only \d+ effective samples were left"
    told = re.search(moves, update.effort)
    assert told is not None, update.effort
    assert int(told[1]) > 0
    for card, marginal in enumerate(update.summary.marginals):
        assert marginal.values.get("true" if hand[card] else "false", 0.0) > 0.9, card


SHAKEN = DEPLETING | {
    "cards.ef": DEPLETING["cards.ef"].replace(
        "initial_belief:", "state_variable: double noise\n\ninitial_belief:"
    ),
    "turn.sd": DEPLETING["turn.sd"].replace(
        "dynamic_model:", "dynamic_model:\nstate__.noise = AOS.SampleUniform(0, 1);"
    ),
}
"""The same with noise that differs in all states, so that particles stay many and their ancestors do not."""


async def test_what_particles_have_by_chance_is_given_up_also_after_a_crash_and_a_change_of_engines():
    dice = random.Random(3)
    hand = [dice.random() < 0.5 for _ in range(CARDS)]

    built = await built_text(SHAKEN)
    async with engine_of(built) as first, engine_of(built) as second:
        for card in range(CARDS // 2):
            await turn_and_look(first, card, hand)
        await kill_engine(first.pid)
        for card in range(CARDS // 2, 3 * CARDS // 4):
            await turn_and_look(first, card, hand)
        await second.import_belief(await first.export_belief())
        for card in range(3 * CARDS // 4, CARDS):
            await turn_and_look(second, card, hand)


DEALT = SHAKEN | {
    "cards.ef": row_of_bools("cards", CARDS, "0").replace(
        "initial_belief:", "state_variable: double noise\n\nstate_variable: bool is_dealt\n\ninitial_belief:"
    )
    + "state.noise = AOS.SampleUniform(0, 1);\n",
    "turn.sd": SHAKEN["turn.sd"]
    .replace(
        "dynamic_model:",
        f"""dynamic_model:
if (!state__.is_dealt) for (int i = 0; i < {CARDS}; i++) state__.cards[i] = AOS.Bernoulli(0.5);
state__.is_dealt = true;""",
    )
    .replace("state.cards[number]", "state__.cards[number]"),
}
"""The same, but the cards are dealt when the first one is turned: the initial belief leaves none open."""


async def test_what_opened_up_since_the_beginning_is_given_up_as_well():
    dice = random.Random(3)
    hand = [dice.random() < 0.5 for _ in range(CARDS)]
    async with engine_of_text(DEALT) as engine:
        for card in range(CARDS):
            await turn_and_look(engine, card, hand)


def seen_through_noise(initial: str, seen: str, says_yes: str) -> dict[str, str]:
    """A sensor that answers by a threshold: nothing but the answer is reported."""
    return {
        "levels.ef": f"""project: levels
horizon: 5
discount: 0.95

state_variable: int level

state_variable: bool high

initial_belief:
{initial}
""",
        "read.sd": f"""project: levels

dynamic_model:
double seen = {seen};
__moduleResponse = {says_yes} ? yes : no;
""",
    }


def normal_probability_below(value: float) -> float:
    return statistics.NormalDist().cdf(value)


async def probabilities_of_high(files: dict[str, str], seeds: range) -> list[float]:
    found = []
    for seed in seeds:
        async with engine_of_text(files, seed=seed) as engine:
            update = await engine.update("read", "yes")
        (high,) = (marginal for marginal in update.summary.marginals if marginal.variable == "high")
        found.append(high.values["true"])
    return found


async def test_an_answer_by_a_threshold_weighs_two_states_by_its_probabilities():
    files = seen_through_noise(
        "state.high = AOS.Bernoulli(0.3);", "AOS.SampleNormal(state.high ? 1 : 0, 1)", "seen > 1"
    )
    likely, unlikely = 0.3 * normal_probability_below(0), 0.7 * normal_probability_below(-1)
    for found in await probabilities_of_high(files, range(101, 109)):
        assert found == pytest.approx(likely / (likely + unlikely), abs=0.002)


async def test_moved_particles_are_no_more_even_than_what_is_believed():
    files = seen_through_noise(
        "state.level = AOS.SampleDiscrete(vector<double>(1000, 0.001));\nstate.high = state.level >= 30;",
        "AOS.SampleNormal(state.level * 0.01, 1)",
        "seen < -1",
    )
    likelihoods = [normal_probability_below(-1 - level / 100) for level in range(1000)]
    found = await probabilities_of_high(files, range(1, 13))
    assert statistics.mean(found) == pytest.approx(sum(likelihoods[30:]) / sum(likelihoods), abs=0.005)
