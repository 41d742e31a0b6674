from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence

State = tuple[int, ...]
"""The values of a world's variables."""

RUNNING, GOAL, FAILURE = 0, 1, 2

NOTHING_SEEN = -1
"""The default observation."""

Seen = int | tuple[tuple[int, float], ...]
"""An observation, or observations with their probabilities."""


@dataclasses.dataclass(frozen=True)
class Outcome:
    """One of the things that an action may lead to; no sum of probabilities has to be exactly 1."""

    probability: float
    next: State
    reward: float = 0.0
    observation: Seen = NOTHING_SEEN
    ending: int = RUNNING


@dataclasses.dataclass(frozen=True)
class World:
    """The product of a family: a POMDP that has not been spelt out."""

    family: str
    discount: float
    horizon: int
    variables: Sequence[str]
    actions: Sequence[str]
    starts: Sequence[tuple[float, State]]
    step: Callable[[State, int], Iterable[Outcome]]
    irrelevant: Sequence[int] = ()
    """Variables that do not matter, and of which the engine is told so."""


class TooLarge(Exception):
    """The problem has more states that can be reached than were allowed."""


@dataclasses.dataclass(frozen=True)
class Problem:
    """A world whose states are listed; `rows` hold (probability, next, sensing, reward)."""

    name: str
    world: World
    states: Sequence[tuple[State, int]]
    sensings: Sequence[tuple[tuple[int, float], ...]]
    starts: Sequence[tuple[int, float]]
    rows: Mapping[tuple[int, int], Sequence[tuple[float, int, int, float]]]

    def with_horizon(self, horizon: int) -> Problem:
        return dataclasses.replace(self, world=dataclasses.replace(self.world, horizon=horizon))

    def text(self) -> str:
        world = self.world
        words = [
            f"problem {self.name}",
            f"discount {world.discount!r} horizon {world.horizon} actions {len(world.actions)}",
            f"variables {len(world.variables)} states {len(self.states)}",
            f"sensings {len(self.sensings)} starts {len(self.starts)}",
            " ".join(map(str, ("irrelevant", len(world.irrelevant), *world.irrelevant))),
        ]
        words += [" ".join(map(str, (*state, ending))) for state, ending in self.states]
        words += [
            _row((observation, repr(odds)) for observation, odds in sensing) for sensing in self.sensings
        ]
        words += [f"{state} {odds!r}" for state, odds in self.starts]
        for number, (_, ending) in enumerate(self.states):
            if ending == RUNNING:
                words += [
                    _row((repr(odds), after, sensing, repr(reward)) for odds, after, sensing, reward in row)
                    for row in (self.rows[number, action] for action in range(len(world.actions)))
                ]
        return "\n".join([*words, "end", ""])


def _row(entries: Iterable[tuple[Hashable, ...]]) -> str:
    listed = list(entries)
    return " ".join([str(len(listed)), *(str(word) for entry in listed for word in entry)])


def tabulate(name: str, world: World, max_states: int) -> Problem:
    """Lists what can be reached from the starts; TooLarge where that is more than `max_states`."""
    numbers: dict[tuple[State, int], int] = {}
    sensings: dict[tuple[tuple[int, float], ...], int] = {}
    rows: dict[tuple[int, int], list[tuple[float, int, int, float]]] = {}
    waiting: list[tuple[State, int]] = []

    def number_of(state: State, ending: int) -> int:
        key = (state, ending)
        if key not in numbers:
            if len(numbers) == max_states:
                raise TooLarge
            numbers[key] = len(numbers)
            waiting.append(key)
        return numbers[key]

    start_odds: dict[int, float] = defaultdict(float)
    for odds, state in world.starts:
        start_odds[number_of(state, RUNNING)] += odds
    whole = sum(start_odds.values())
    while waiting:
        key = waiting.pop()
        state, ending = key
        if ending != RUNNING:
            continue
        for action in range(len(world.actions)):
            merged: dict[tuple[int, int, float], float] = defaultdict(float)
            for outcome in world.step(state, action):
                if outcome.probability <= 0:
                    continue
                responses = (
                    outcome.observation
                    if isinstance(outcome.observation, tuple)
                    else ((outcome.observation, 1.0),)
                )
                sensing = sensings.setdefault(_normalised(responses), len(sensings))
                merged[number_of(outcome.next, outcome.ending), sensing, outcome.reward] += (
                    outcome.probability
                )
            total = sum(merged.values())
            rows[numbers[key], action] = [
                (odds / total, after, sensing, reward) for (after, sensing, reward), odds in merged.items()
            ]
    starts = [(state, odds / whole) for state, odds in start_odds.items()]
    return Problem(name, world, list(numbers), list(sensings), starts, rows)


def _normalised(responses: tuple[tuple[int, float], ...]) -> tuple[tuple[int, float], ...]:
    merged: dict[int, float] = defaultdict(float)
    for observation, odds in responses:
        merged[observation] += odds
    total = sum(merged.values())
    return tuple((observation, odds / total) for observation, odds in sorted(merged.items()) if odds > 0)
