"""Beliefs that are kept and conditioned on what somebody knows, against enumeration in Python."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

from models import built_bundle, engine_of

from aos_language.load import load_bundle
from aos_protocol.messages import StartMission
from aos_solver.child.engine import Engine
from aos_solver.mission.beginning import begin_with
from aos_solver.mission.conditions import built_with_conditions

_BUNDLE = Path(__file__).resolve().parents[2] / "deploy/bundles/errand"
_ROOMS = ("office", "lab", "kitchen")
_VARIABLES = ("robot", "at[alice]", "at[bob]")
REFUTED_BELOW = 0.01


async def largest_difference(seed: int, cache_dir: Path) -> float | None:
    """Returns by how much a belief that is kept and conditioned differs from its enumeration, state by state.

    None where the condition is impossible in both.
    """
    chance = random.Random(seed)
    text, holds = _condition(chance)
    project = load_bundle(_BUNDLE).project
    assert project is not None
    built = await built_bundle(_BUNDLE, cache_dir)

    async def conditioned() -> Engine:
        return await Engine.start(await built_with_conditions(project, [text], cache_dir), seed=seed)

    async with engine_of(built, seed=seed) as last, engine_of(built, seed=seed) as engine:
        await _play(last, chance)
        before = await _belief(last)
        expected = {state: weight for state, weight in before.items() if holds(state)}
        start = StartMission("keep", (text,))
        if not expected:
            return None
        await begin_with(engine, start, await last.export_beliefs(), conditioned, REFUTED_BELOW)
        total = sum(expected.values())
        after = await _belief(engine)
        return max(
            abs(after.get(state, 0.0) - expected.get(state, 0.0) / total) for state in {*after, *expected}
        )


State = tuple[int, ...]


async def _belief(engine: Engine) -> dict[State, float]:
    """The weights of the states: robot, alice, bob, whether the parcel is given. Endings are left out."""
    weights: dict[State, float] = {}
    for weight, text in (await engine.export_belief()).particles:
        state = tuple(map(int, text.split()[:4]))
        weights[state] = weights.get(state, 0.0) + weight
    return weights


async def _play(engine: Engine, chance: random.Random) -> None:
    """Some random steps, as a random world of the model observes them."""
    await engine.reset_world(chance.randrange(2**31))
    for _ in range(chance.randint(0, 4)):
        index = chance.randrange(len(engine.description.actions))
        step = await engine.step_world(index)
        await engine.update(engine.description.actions[index].name, step.response)


def _condition(chance: random.Random) -> tuple[str, object]:
    """A random expression, in the documents' language and as a function of a state."""
    kind = chance.random()
    if kind < 0.25:
        (left, at), (right, there) = (_operand(chance) for _ in range(2))
        return f"{left} == {right}", lambda state: at(state) == there(state)
    clauses = [_clause(chance) for _ in range(chance.randint(1, 3))]
    if kind < 0.6:
        return " && ".join(text for text, _ in clauses), lambda state: all(
            is_so(state) for _, is_so in clauses
        )
    if kind < 0.9:
        return " || ".join(text for text, _ in clauses), lambda state: any(
            is_so(state) for _, is_so in clauses
        )
    text, is_so = clauses[0]
    return f"!({text})", lambda state: not is_so(state)


def _operand(chance: random.Random) -> tuple[str, Callable[[Any], Any]]:
    number = chance.randrange(len(_VARIABLES))
    return f"state.{_VARIABLES[number]}", lambda state: state[number]


def _clause(chance: random.Random) -> tuple[str, Callable[[Any], bool]]:
    if chance.random() < 0.15:
        return "!state.is_given", lambda state: not state[3]
    name, value = _operand(chance)
    room = chance.randrange(len(_ROOMS))
    if chance.random() < 0.5:
        return f"{name} == {_ROOMS[room]}", lambda state: value(state) == room
    return f"{name} != {_ROOMS[room]}", lambda state: value(state) != room
