"""Alpha vectors: for every plan that was found, its value in every state."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np

from aos_protocol.errors import PlanningError
from aos_solver.offline.explicit_model import Floats, Integers

__all__ = ["AlphaVectors", "Choice", "RegionVectors", "read_alpha_vectors"]

_MARK = b"AOSALPH1"


class RegionVectors(msgspec.Struct, frozen=True):
    """The vectors over the states of one region: `values[k, i]` is what plan k gives in `states[i]`.

    Plan k begins with `actions[k]`. A region holds all states of every belief that touches it.
    """

    states: Integers
    actions: Integers
    values: Floats


class Choice(msgspec.Struct, frozen=True):
    """The best action at a belief; for every action the best value of a plan that begins with it, and how
    many such plans there are."""

    action: int
    values: Floats
    plans: Integers


class AlphaVectors(msgspec.Struct, frozen=True):
    """A policy: at a belief the action of the vector with the highest expected value is taken.

    Every action has a vector in every region. States in no region are worth nothing.
    """

    action_count: int
    regions: tuple[RegionVectors, ...]

    @property
    def count(self) -> int:
        return sum(len(region.actions) for region in self.regions)

    def region_of(self, state_count: int) -> tuple[Integers, Integers]:
        """For every state its region, or -1, and its place in it."""
        region, place = np.full(state_count, -1), np.zeros(state_count, dtype=np.int64)
        for number, part in enumerate(self.regions):
            region[part.states] = number
            place[part.states] = np.arange(len(part.states))
        return region, place

    def choose(self, belief: Floats) -> Choice:
        """The choice at a belief, which has a weight for every state.

        Where the belief spreads over several regions, which an observation would tell apart, a plan of its
        own is followed in each.
        """
        values = np.zeros(self.action_count)
        plans = np.zeros(self.action_count, dtype=np.int64)
        for region in self.regions:
            weights = belief[region.states]
            if not weights.any():
                continue
            best = np.full(self.action_count, -np.inf)
            np.maximum.at(best, region.actions, region.values @ weights)
            values += best
            plans += np.bincount(region.actions, minlength=self.action_count)
        return Choice(int(np.argmax(values)), values, plans)


def read_alpha_vectors(path: Path, action_count: int) -> AlphaVectors:
    """What the solver has written; `cpp/policy_file.hpp` describes it."""
    data = path.read_bytes()
    if not data.startswith(_MARK):
        raise PlanningError(f"{path} holds no alpha vectors", code="AOS321")
    place = len(_MARK)

    def take(kind: str, count: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        nonlocal place
        array = np.frombuffer(data, kind, count, place)
        place += array.nbytes
        return array.astype(np.int64)

    regions, states, vectors = (int(number) for number in take("<u8", 3))
    first = take("<u8", regions + 1)
    listed = take("<u4", states)
    actions: list[list[int]] = [[] for _ in range(regions)]
    values: list[list[Floats]] = [[] for _ in range(regions)]
    for _ in range(vectors):
        region, action = (int(number) for number in take("<u4", 2))
        length = int(first[region + 1] - first[region])
        actions[region].append(action)
        values[region].append(np.frombuffer(data, "<f8", length, place))
        place += 8 * length
    return AlphaVectors(
        action_count,
        tuple(
            RegionVectors(
                listed[first[number] : first[number + 1]], np.array(actions[number]), np.array(values[number])
            )
            for number in range(regions)
        ),
    )
