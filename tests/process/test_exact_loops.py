import json
from fractions import Fraction

import pytest
from commands import aos
from models import engine_of_text
from texts import write_texts

from aos_protocol.messages import BeliefSummary
from aos_solver.child.engine import Engine

ENVIRONMENT = """project: loops
horizon: 2
discount: 0.5

state_variable: int side

state_variable: int spot

shared_code:
int rolled(int least) {
    int face = 0;
    while (face < least) face = AOS.SampleDiscrete(-1, {0.5, 0.2, 0.3});
    return face;
}

initial_belief:
while (state.side == 0) {
    state.side = (AOS.Bernoulli(0.5) ? 0 : 1) * (AOS.Bernoulli(0.25) ? 1 : 2);
}
"""
SIDES = {1: Fraction(1, 4), 2: Fraction(3, 4)}
SKILL = """project: loops

dynamic_model:
{code}
__reward += state__.spot;
__moduleResponse = state__.spot > 1 ? yes : no;
"""


def walk_up(side: int) -> Fraction:
    """The probability that a walk on 0..4, up with a fifth of its place, comes to 4 before 0.

    With h(0) = 0 and h(4) = 1, h(i) = u(i) h(i + 1) + (1 - u(i)) h(i - 1) gives the steps of h by factors.
    """
    steps = [Fraction(1)]
    for place in (1, 2, 3):
        up = Fraction(place, 5)
        steps.append(steps[-1] * (1 - up) / up)
    return sum(steps[:side], Fraction()) / sum(steps, Fraction())


def sum_of_rolls(rolls: int) -> dict[int, Fraction]:
    sums = {0: Fraction(1)}
    for _ in range(rolls):
        sums = {
            total: sum((sums.get(total - face, Fraction()) * odds for face, odds in ROLL.items()), Fraction())
            for total in range(max(sums) + 3)
        }
    return {total: odds for total, odds in sums.items() if odds}


ROLL = {1: Fraction(2, 5), 2: Fraction(3, 5)}
NESTED = """int kept = 0;
while (kept == 0) {
    int roll;
    do { roll = AOS.SampleDiscrete(-1, {0.4, 0.3, 0.2, 0.1}); } while (roll == 0);
    if (AOS.Bernoulli(0.25 * roll)) kept = roll;
}
state__.spot = kept;"""
DEPENDENT = """state__.spot = state.side;
while (state__.spot > 0 && state__.spot < 4) state__.spot += AOS.Bernoulli(0.2 * state__.spot) ? 1 : -1;"""
IN_A_LAMBDA = """auto roll = [&]() {
    int face = 0;
    while (face == 0) face = AOS.SampleDiscrete(-1, {0.5, 0.2, 0.3});
    return face;
};
int sum = 0;
for (int i = 0; i < 3; i++) sum += roll();
state__.spot = sum;"""
BROKEN_OFF = """vector<int> faces;
for (;;) {
    faces.clear();
    for (int i = 0; i < 3; i++) faces.push_back(AOS.Bernoulli(0.5) ? 1 : 0);
    if (faces[0] + faces[1] + faces[2] == 1) break;
}
state__.spot = faces[0] + 2 * faces[1] + 3 * faces[2];"""
REDRAWN = """state__.spot = 0;
for (int i = 0; i < 2; i++) {
    int face = AOS.SampleDiscrete(-1, {0.5, 0.2, 0.3});
    if (face == 0) i--;
    state__.spot += face;
}"""
UTILITIES = """state__.spot = 0;
while (state__.spot == 0) state__.spot = AOSUtils::SampleDiscrete(vector<double>{0.5, 0.2, 0.3});"""
POINTED = """int total = 0;
int* where = &total;
while (AOS.Bernoulli(0.5)) *where = 1 - *where;
state__.spot = total;"""
UNENTERED = """state__.spot = 0;
while (state__.spot < 0) state__.spot = AOS.SampleDiscrete(-1, {0.5, 0.5});
while (state__.spot == 0) state__.spot = AOS.SampleDiscrete(-1, {0.5, 0.2, 0.3});"""
EXACT: dict[str, tuple[str, dict[int, Fraction]]] = {
    "again": (
        "state__.spot = 0; while (state__.spot == 0) { state__.spot = AOS.Bernoulli(0.5) ? 0 : 1; }",
        {1: Fraction(1)},
    ),
    "nested": (NESTED, {1: Fraction(3, 10), 2: Fraction(4, 10), 3: Fraction(3, 10)}),
    "dependent": (
        DEPENDENT,
        {
            4: sum((odds * walk_up(side) for side, odds in SIDES.items()), Fraction()),
            0: sum((odds * (1 - walk_up(side)) for side, odds in SIDES.items()), Fraction()),
        },
    ),
    "lambda": (IN_A_LAMBDA, sum_of_rolls(3)),
    "broken_off": (BROKEN_OFF, {1: Fraction(1, 3), 2: Fraction(1, 3), 3: Fraction(1, 3)}),
    "shared": ("state__.spot = 0; state__.spot = rolled(1) + rolled(1);", sum_of_rolls(2)),
    "redrawn": (REDRAWN, sum_of_rolls(2)),
    "utilities": (UTILITIES, ROLL),
    "pointed": (POINTED, {0: Fraction(2, 3), 1: Fraction(1, 3)}),
    "unentered": (UNENTERED, ROLL),
}


COUNTER = """int rounds = 0;
while (AOS.Bernoulli(0.5)) rounds++;
state__.spot = rounds % 2;"""
PAID = """do { __reward -= 1; } while (AOS.Bernoulli(0.75));
state__.spot = 0;"""
HEARD = """int heard = 0;
while (heard == 0) {
    heard = AOS.SampleDiscrete(-1, {0.5, state.side == 1 ? 0.4 : 0.1, state.side == 1 ? 0.1 : 0.4});
}
__reward = 0;
__moduleResponse = heard == 1 ? yes : no;"""
GIVEN = """
state_given_observation:
do { state___.spot = AOS.SampleDiscrete(-1, {0.25, 0.5, 0.25}); } while (state___.spot == 1);
"""


def document(code: str) -> str:
    return SKILL.format(code=code)


def files() -> dict[str, str]:
    return {
        "loops.ef": ENVIRONMENT,
        **{f"{name}.sd": document(code) for name, (code, _) in EXACT.items()},
        "counter.sd": document(COUNTER),
        "paid.sd": document(PAID),
        "heard.sd": f"project: loops\n\ndynamic_model:\n{HEARD}\n",
        "given.sd": f"project: loops\n\ndynamic_model:\n__moduleResponse = yes;\n{GIVEN}",
    }


def spots(belief: BeliefSummary) -> dict[str, float]:
    return next(marginal.values for marginal in belief.marginals if marginal.variable == "spot")


def approximately(odds: dict[int, Fraction]) -> dict[str, float]:
    return {str(value): pytest.approx(float(odds), abs=1e-12) for value, odds in odds.items()}


async def test_beliefs_and_values_after_loops_are_closed_forms():
    async with engine_of_text(files()) as engine:
        start = await engine.summary()
        sides = {str(side): pytest.approx(float(odds), abs=1e-12) for side, odds in SIDES.items()}
        assert start.is_exact
        assert start.error_bound == 0
        assert start.marginals[0].values == sides
        for name, (_, odds) in EXACT.items():
            after = (await engine.update_without_observation(name, ran_probability=1)).summary
            assert after.error_bound == 0, name
            assert spots(after) == approximately(odds), name
            await engine.reset_belief()
        await check_values(engine)
        await check_sensor(engine)
        await check_correction(engine)
        await check_counter(engine)


async def check_values(engine: Engine):
    values = {value.action: value.q for value in (await engine.exact_values(1)).actions}
    for name, (_, odds) in EXACT.items():
        mean = sum((value * probability for value, probability in odds.items()), Fraction())
        assert values[name] == pytest.approx(float(mean), abs=1e-9), name
    assert values["counter"] == pytest.approx(1 / 3, abs=1e-6)
    assert values["paid"] == pytest.approx(-4, abs=1e-5)


async def check_sensor(engine: Engine):
    update = await engine.update("heard", "yes")
    odds = SIDES[1] * Fraction(4, 5) / (SIDES[1] * Fraction(4, 5) + SIDES[2] * Fraction(1, 5))
    assert update.summary.error_bound == 0
    assert update.summary.marginals[0].values["1"] == pytest.approx(float(odds), abs=1e-12)
    await engine.reset_belief()


async def check_correction(engine: Engine):
    after = (await engine.update("given", "yes", {"response": '"yes"'})).summary
    assert after.error_bound == 0
    assert spots(after) == approximately({0: Fraction(1, 2), 2: Fraction(1, 2)})
    await engine.reset_belief()


async def check_counter(engine: Engine):
    """A counter makes every round another one: what is left out is negligible, and the belief is exact."""
    after = (await engine.update_without_observation("counter", ran_probability=1)).summary
    assert after.is_exact
    assert 0 < after.error_bound < 1e-6
    assert spots(after)["0"] == pytest.approx(2 / 3, abs=1e-6)
    values = await engine.exact_values(2)
    assert values.error > 2 * after.error_bound, "the largest reward is more than 1"
    await engine.reset_belief()


ISSUE = """project: loops
horizon: 3
discount: 0.5

state_variable: int side

state_variable: int wind

initial_belief:
while (state.side == 0) {
    state.side = (AOS.Bernoulli(0.5) ? 0 : 1) * (AOS.Bernoulli(0.25) ? 1 : 2);
}

extrinsic_code:
while (state_.wind < 1) state_.wind = (AOS.Bernoulli(0.5) ? 0 : 1) + (AOS.Bernoulli(0.5) ? 0 : 2);
"""
TURN = """project: loops

dynamic_model:
__reward = state.side + state_.wind;
state__.wind = 0;
__moduleResponse = yes;
"""


def test_the_command_plans_exactly_after_a_loop(tmp_path):
    mean = sum((side * odds for side, odds in SIDES.items()), Fraction())
    files = {"loops.ef": ISSUE, "turn.sd": TURN}
    write_texts(files, tmp_path)
    result = aos("plan", tmp_path, "--exact", "--json")
    assert result.exit_code == 0, result.output
    (action,) = json.loads(result.stdout)["actions"]
    # The wind is 1, 2 or 3 with equal odds, anew in each of the three steps.
    assert action["q"] == pytest.approx(float((mean + 2) * Fraction(7, 4)), abs=1e-9)
