"""Alpha vectors: for every plan that was found, its value in every state.

In a file they come after a line of JSON that has the sizes of the regions, as little-endian arrays without
gaps: for every region, in the line's order, u32 states[states], u32 actions[vectors], and f64
values[vectors][states].
"""

from collections.abc import Sequence
from typing import Self

import msgspec
import numpy as np

from aos_solver.offline.explicit_model import Floats, Integers, PackedArrays


class RegionSize(msgspec.Struct, frozen=True):
    """The numbers of a region's states and vectors."""

    states: int
    vectors: int


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

    @classmethod
    def of_bytes(cls, action_count: int, sizes: Sequence[RegionSize], data: bytes) -> Self:
        """Those of a file behind its line; ValueError if the length is wrong."""
        arrays, regions = PackedArrays(data), []
        for size in sizes:
            states = arrays.take("<u4", size.states).astype(np.int64)
            actions = arrays.take("<u4", size.vectors).astype(np.int64)
            values = arrays.take("<f8", size.states * size.vectors).reshape(size.vectors, size.states)
            regions.append(RegionVectors(states, actions, values))
        if arrays.place != len(data):
            raise ValueError("its length is wrong")
        return cls(action_count, tuple(regions))

    def to_bytes(self) -> bytes:
        """Returns the bytes of a file behind its line."""
        return b"".join(
            array.astype(kind).tobytes()
            for region in self.regions
            for array, kind in ((region.states, "<u4"), (region.actions, "<u4"), (region.values, "<f8"))
        )

    @property
    def sizes(self) -> tuple[RegionSize, ...]:
        return tuple(RegionSize(len(region.states), len(region.actions)) for region in self.regions)

    @property
    def count(self) -> int:
        return sum(len(region.actions) for region in self.regions)

    def region_of(self, state_count: int) -> tuple[Integers, Integers]:
        """Returns for every state its region, or -1, and its place in it."""
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
