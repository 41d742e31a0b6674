"""Families of random worlds, each with what a tuned planner may get wrong.

A family draws its own sizes, noise, rewards and discount; `large` asks for what is hard to find: long ways,
many states.
"""

import random
from collections.abc import Callable, Sequence

from .hidden import boxes, doors, exits, hallway, machine, machines, pursuit, rocks, search
from .plain import counter, dense, endings, ties
from .problem import World
from .ways import battery, corridor, grid, heaven, invest, keys, late, lock, pushing

Family = Callable[[random.Random, bool], World]

FAMILIES: dict[str, Family] = {
    family.__name__: family
    for family in (
        dense, corridor, grid, keys, pushing, doors, late, counter, ties, exits, endings, battery, heaven,
        lock, boxes, rocks, machine, invest, pursuit, search, hallway, machines,
    )
}  # fmt: skip

NEEDLES: Sequence[str] = ("corridor", "keys", "pushing", "late", "lock", "heaven")
"""Families of which the large ones are needles in haystacks."""
