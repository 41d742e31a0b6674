from collections.abc import AsyncIterator
from pathlib import Path

import msgspec
import numpy as np
import pytest
from models import engine_of, engine_of_text

from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine

WORLDS = 5
STATES = 3
ACTIONS = 2
HORIZON = 4
DISCOUNT = 0.9

SKILL = """project: chance
parameter: int choice

available_parameters_code:
for (int choice = 0; choice < 2; choice++) __possibleParameters.push_back(std::make_tuple(choice));

dynamic_model:
int row = (state.world * 2 + choice) * 3 + state.place;
__reward = state.rewards[row];
std::vector<double> odds = {state.moves[3 * row], state.moves[3 * row + 1], state.moves[3 * row + 2]};
state__.place = AOS.SampleDiscrete(odds);
__moduleResponse = AOS.Bernoulli(state.alarms[row - state.place + state__.place]) ? alarm : quiet;
"""


class Chance:
    """Random POMDPs, one for each value of the variable `world`: three places, two actions, two responses."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.moves = random.dirichlet(np.ones(STATES), size=(WORLDS, ACTIONS, STATES))
        self.alarms = random.random((WORLDS, ACTIONS, STATES))
        self.rewards = random.normal(size=(WORLDS, ACTIONS, STATES))

    def documents(self) -> dict[str, str]:
        """Returns the documents as SDL; the numbers are written without loss."""
        tables = "\n".join(
            f"state_variable: double {name} []\ncode:\nstate.{name} = {{{', '.join(map(repr, values))}}};\n"
            for name, values in (
                ("moves", self.moves.ravel().tolist()),
                ("alarms", self.alarms.ravel().tolist()),
                ("rewards", self.rewards.ravel().tolist()),
            )
        )
        environment = f"""project: chance
horizon: {HORIZON}
discount: {DISCOUNT}

state_variable: int world

state_variable: int place

{tables}
initial_belief:
state.world = AOS.SampleDiscrete(std::vector<double>({WORLDS}, 1.0 / {WORLDS}));
state.place = AOS.SampleDiscrete(std::vector<double>({STATES}, 1.0 / {STATES}));
"""
        return {"chance.ef": environment, "act.sd": SKILL}

    def posterior(
        self, world: int, belief: np.ndarray, action: int, is_alarm: bool
    ) -> tuple[np.ndarray, float]:
        """Bayes' rule, and the probability of what was observed."""
        alarms = self.alarms[world, action]
        joint = (belief @ self.moves[world, action]) * (alarms if is_alarm else 1 - alarms)
        return joint / joint.sum(), float(joint.sum())

    def values(self, world: int, belief: np.ndarray, horizon: int) -> list[float]:
        """Returns the values of both actions with so many decisions to go, by going through all that may
        be observed."""
        found = []
        for action in range(ACTIONS):
            value = float(belief @ self.rewards[world, action])
            for is_alarm in (False, True) if horizon > 1 else ():
                after, probability = self.posterior(world, belief, action, is_alarm)
                value += DISCOUNT * probability * max(self.values(world, after, horizon - 1))
            found.append(value)
        return found


CHANCE = Chance(seed=20261121)


@pytest.fixture
async def chance(cache_dir: Path) -> AsyncIterator[Engine]:
    """An engine that may be in any of the random worlds."""
    async with engine_of_text(CHANCE.documents(), cache_dir) as engine:
        yield engine


async def _enter(engine: Engine, world: int) -> None:
    """The belief that this is the world, and that the robot may be anywhere in it."""
    await engine.reset_belief()
    everything = await engine.export_belief()
    per_world = len(everything.particles) // WORLDS
    particles = everything.particles[world * per_world : (world + 1) * per_world]
    summary = await engine.import_belief(msgspec.structs.replace(everything, particles=particles))
    assert {m.variable: m.values for m in summary.marginals}["world"] == {str(world): pytest.approx(1)}


@pytest.mark.parametrize("world", range(WORLDS))
async def test_random_worlds_have_the_values_that_an_independent_program_gives(world: int, chance: Engine):
    await _enter(chance, world)
    truth = CHANCE.values(world, np.full(STATES, 1 / STATES), HORIZON)
    exact = [value.q for value in (await chance.exact_values()).actions]
    assert exact == pytest.approx(truth, abs=1e-9)
    plan = await chance.plan(simulations=200_000, seed=1, planner="pomcp")
    assert plan.best.q == pytest.approx(max(truth), abs=0.03)
    assert max(truth) - truth[plan.index] < 0.03


async def test_a_short_look_ahead_has_the_tigers_exact_value(tiger: BuiltModel):
    async with engine_of(tiger) as engine:
        exact = {value.action: value.q for value in (await engine.exact_values(4)).actions}
        plan = await engine.plan(simulations=200_000, seed=2, horizon=4, planner="pomcp")
    assert plan.best.q == pytest.approx(max(exact.values()), abs=0.3)
    assert exact[plan.best.action] == max(exact.values())


async def test_threads_that_share_a_budget_repeat_to_the_bit(tiger: BuiltModel):
    async def decide() -> Plan:
        async with engine_of(tiger) as engine:
            await engine.plan(simulations=5_001, seed=4, threads=3, planner="pomcp")
            await engine.update("listen", "tiger_left")
            return await engine.plan(simulations=5_001, seed=5, threads=3, planner="pomcp")

    first, again = await decide(), await decide()
    assert first.actions == again.actions
    assert first.simulations == 5_001
    assert first.known_simulations == again.known_simulations > 0


async def test_threads_decide_as_one_thread_does(chance: Engine):
    await _enter(chance, 0)
    alone = await chance.plan(simulations=100_000, seed=1, planner="pomcp")
    await _enter(chance, 0)
    together = await chance.plan(simulations=100_000, seed=1, threads=2, planner="pomcp")
    assert together.index == alone.index
    assert together.best.q == pytest.approx(alone.best.q, abs=0.03)


async def test_pondering_while_acting_leaves_a_warm_start_and_stops_when_it_is_asked(tiger: BuiltModel):
    async with engine_of(tiger) as engine:
        await engine.plan(simulations=100, seed=1, planner="pomcp")
        await engine.update("listen", "tiger_left")
        idle = await engine.plan(simulations=100, seed=2, planner="pomcp")
        await engine.ponder(idle.index, seed=3, time_s=0.2)
        predicted = await engine.predict(idle.index)  # What is asked now ends the pondering...
        await engine.ponder(idle.index, seed=3, time_s=60)
        await engine.update(idle.best.action, predicted.predicted[0].response)  # ...and so does this.
        warm = await engine.plan(simulations=100, seed=4, planner="pomcp")
    assert warm.known_simulations > idle.known_simulations
