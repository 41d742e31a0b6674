"""A POMDP as numbers: every state, every outcome of every action. To end the mission may be one more."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_MARK = b"AOSFLAT1"
_ENTRY = np.dtype([("number", "<u4"), ("sensing", "<u4"), ("probability", "<f8")])
"""An element of a row in a file. Only outcomes have a sensing."""


class Ragged(msgspec.Struct, frozen=True):
    """Rows of different lengths: row k is `numbers[first[k]:first[k + 1]]` with `probabilities` beside it."""

    first: Integers
    numbers: Integers
    probabilities: Floats

    def __len__(self) -> int:
        return len(self.first) - 1

    def with_certain_row(self, number: int) -> Ragged:
        """Returns it with one row more, which has this number alone."""
        first = np.r_[self.first, self.first[-1] + 1]
        return Ragged(first, np.r_[self.numbers, number], np.r_[self.probabilities, 1.0])

    def entries(self, sensings: Integers | int = 0) -> NDArray[Any]:
        """The elements as they stand in a file."""
        entries = np.empty(len(self.numbers), _ENTRY)
        entries["number"], entries["sensing"] = self.numbers, sensings
        entries["probability"] = self.probabilities
        return entries

    def row(self, index: int) -> tuple[Integers, Floats]:
        """The numbers of a row and their probabilities."""
        part = slice(self.first[index], self.first[index + 1])
        return self.numbers[part], self.probabilities[part]

    @property
    def row_numbers(self) -> Integers:
        return np.repeat(np.arange(len(self)), np.diff(self.first))


class StartBelief(msgspec.Struct, frozen=True):
    """One of the beliefs that the robot may start with, and knows which: `weight` is how likely it is."""

    weight: float
    states: Integers
    probabilities: Floats


class ModelSize(msgspec.Struct, frozen=True):
    """The size of a model; `outcomes` counts (state, action, next state)."""

    states: int
    actions: int
    observations: int
    outcomes: int


class FlatModel(msgspec.Struct, frozen=True, kw_only=True):
    """A POMDP without names: states, actions and observations are numbers.

    `rewards` (states, actions) are expected immediate rewards. Row `state * actions + action` of `outcomes`
    holds the next states; `sensings` beside them names for each a row of `likelihoods`, the distribution of
    what is observed there. Outcomes of most models share few of these, and mostly the next state and the
    action decide about it.
    """

    discount: float
    rewards: Floats
    outcomes: Ragged
    sensings: Integers
    likelihoods: Ragged
    starts: tuple[StartBelief, ...]


class ExplicitModel(FlatModel, frozen=True, kw_only=True):
    """One with names, by the numbers of states, actions and observations."""

    name: str
    states: tuple[str, ...]
    actions: tuple[str, ...]
    observations: tuple[str, ...]

    @property
    def size(self) -> ModelSize:
        return ModelSize(
            len(self.states), len(self.actions), len(self.observations), len(self.outcomes.numbers)
        )

    def start_distribution(self) -> Floats:
        """The probability of every state at the start, before the robot is told anything."""
        start = np.zeros(len(self.states))
        for belief in self.starts:
            np.add.at(start, belief.states, belief.weight * belief.probabilities)
        return start

    def write_flat(self, path: Path) -> None:
        """The file that the solver reads; `cpp/point_based/flat_file.hpp` describes it."""
        starts = Ragged(
            np.cumsum([0, *(len(start.states) for start in self.starts)]),
            np.concatenate([start.states for start in self.starts]),
            np.concatenate([start.probabilities for start in self.starts]),
        )
        counts = [*msgspec.structs.astuple(self.size), len(self.likelihoods), len(self.likelihoods.numbers)]
        with path.open("wb") as file:
            file.write(_MARK)
            for array, kind in (
                ([*counts, len(starts), len(starts.numbers)], "<u8"),
                ([self.discount], "<f8"),
                (self.rewards, "<f8"),
                (self.outcomes.first, "<u8"),
                (self.outcomes.entries(self.sensings), _ENTRY),
                (self.likelihoods.first, "<u8"),
                (self.likelihoods.entries(), _ENTRY),
                ([start.weight for start in self.starts], "<f8"),
                (starts.first, "<u8"),
                (starts.entries(), _ENTRY),
            ):
                np.asarray(array).astype(kind).tofile(file)


def with_more_outcomes(
    model: FlatModel, rows: Integers, row_count: int, more: Integers, state: int, chances: Floats
) -> tuple[Ragged, Integers]:
    """The model's outcomes and their sensings, with new numbers of their `rows`.

    In each of the rows `more` there is one outcome more, which leads to `state`. What is observed then has a
    sensing of its own, after the model's.
    """
    rows = np.r_[rows, more]
    order = np.argsort(rows, kind="stable")
    first = np.searchsorted(rows[order], np.arange(row_count + 1))
    numbers = np.r_[model.outcomes.numbers, np.full(len(more), state)]
    sensings = np.r_[model.sensings, np.full(len(more), len(model.likelihoods))]
    probabilities = np.r_[model.outcomes.probabilities, chances]
    return Ragged(first, numbers[order], probabilities[order]), sensings[order]


class PackedArrays:
    """Arrays that stand one after the other in bytes; the next one begins at `place`."""

    def __init__(self, data: bytes, place: int = 0) -> None:
        self._data = data
        self.place = place

    def take(self, kind: Any, count: int) -> NDArray[Any]:
        """The next array; ValueError if the bytes end before."""
        array = np.frombuffer(self._data, kind, count, self.place)
        self.place += array.nbytes
        return array


def read_flat(data: bytes) -> FlatModel:
    """The model that an engine has written."""
    take = PackedArrays(data, len(_MARK)).take

    def rows(count: int, entries: int) -> tuple[Ragged, Integers]:
        first, found = take("<u8", count + 1).astype(np.int64), take(_ENTRY, entries)
        numbers, sensings = found["number"].astype(np.int64), found["sensing"].astype(np.int64)
        return Ragged(first, numbers, found["probability"].copy()), sensings

    states, actions, _, outcomes, sensings, likelihoods, starts, entries = map(int, take("<u8", 8))
    discount = float(take("<f8", 1)[0])
    rewards = take("<f8", states * actions).reshape(states, actions)
    found, sensing_of = rows(states * actions, outcomes)
    sensed, _ = rows(sensings, likelihoods)
    weights = take("<f8", starts)
    beliefs, _ = rows(starts, entries)
    return FlatModel(
        discount=discount,
        rewards=rewards,
        outcomes=found,
        sensings=sensing_of,
        likelihoods=sensed,
        starts=tuple(StartBelief(float(weights[i]), *beliefs.row(i)) for i in range(starts)),
    )


STOP = "stop"


def with_stopping(model: ExplicitModel, value: float) -> ExplicitModel:
    """The model with a last action `stop`, which is worth `value` wherever the mission goes on.

    It leads to one more state, the last one, that nothing leaves and nothing is worth anything in.
    """
    states, actions = len(model.states), len(model.actions)
    state, action = np.divmod(model.outcomes.row_numbers, actions)
    stops = np.arange(states) * (actions + 1) + actions
    more = np.r_[stops, states * (actions + 1) + np.arange(actions + 1)]
    rows, row_count = state * (actions + 1) + action, (states + 1) * (actions + 1)
    outcomes, sensings = with_more_outcomes(model, rows, row_count, more, states, np.ones(len(more)))
    rewards = np.zeros((states + 1, actions + 1))
    rewards[:states, :actions] = model.rewards
    rewards[:states, actions] = np.where(over_states(model), 0.0, value)
    return replace(
        model,
        states=(*model.states, "stopped"),
        actions=(*model.actions, STOP),
        observations=(*model.observations, "stopped"),
        rewards=rewards,
        outcomes=outcomes,
        sensings=sensings,
        likelihoods=model.likelihoods.with_certain_row(len(model.observations)),
    )


def over_states(model: ExplicitModel) -> NDArray[np.bool_]:
    """The states that nothing leaves and in which nothing is worth anything."""
    actions = len(model.actions)
    state = model.outcomes.row_numbers // actions
    is_left = np.zeros(len(model.states), dtype=bool)
    is_left[state[model.outcomes.numbers != state]] = True
    is_free: NDArray[np.bool_] = (model.rewards == 0).all(axis=1)
    return ~is_left & is_free
