"""The place of each number that a robot may observe in a row of numbers.

Names of all skills share a row: a name has one column, or as many as there is room for where it is an array.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from aos_solver.child.answers.worlds import WorldSteps
from aos_solver.emission.program import Observed

_INDEX_BITS = 16


class Numbers(NamedTuple):
    """A row for each world; what was not reported is 0 in both arrays."""

    values: NDArray[np.float64]
    is_reported: NDArray[np.int8]


class NumberColumns:
    """`names` are those of the columns: `depth_m`, `echoes_m[0]`, `echoes_m[1]`, ..."""

    def __init__(
        self, skills: Sequence[str], observed: Mapping[str, tuple[Observed, ...]], array_room: int
    ) -> None:
        """`skills` are those of the actions, in their order."""
        widths: dict[str, int] = {}
        for number in (number for numbers in observed.values() for number in numbers):
            width = array_room if number.is_array else 1
            widths[number.name] = max(width, widths.get(number.name, 0))
        self.names: tuple[str, ...] = ()
        first: dict[str, int] = {}
        for name, width in sorted(widths.items()):
            first[name] = len(self.names)
            self.names += (name,) if width == 1 else tuple(f"{name}[{index}]" for index in range(width))
        most = max((len(numbers) for numbers in observed.values()), default=0)
        self._first = np.zeros((len(skills), most), np.int64)
        self._width = np.ones((len(skills), most), np.int64)
        for action, skill in enumerate(skills):
            for place, number in enumerate(observed.get(skill, ())):
                self._first[action, place] = first[number.name]
                self._width[action, place] = widths[number.name]

    def rows(self, actions: NDArray[np.int32], steps: WorldSteps) -> Numbers:
        """Returns the numbers observed in each world after an action in each; elements without a column
        are left out."""
        shape = (len(actions), len(self.names))
        numbers = Numbers(np.zeros(shape), np.zeros(shape, np.int8))
        worlds = np.frombuffer(steps.number_worlds, np.int32)
        keys = np.frombuffer(steps.number_keys, np.uint32).astype(np.int64)
        values = np.frombuffer(steps.number_values, np.float64)
        place, index = keys >> _INDEX_BITS, keys & ((1 << _INDEX_BITS) - 1)
        if not len(keys):
            return numbers
        has_column = index < self._width[actions[worlds], place]
        column = self._first[actions[worlds], place] + index
        at = worlds[has_column], column[has_column]
        numbers.values[at] = values[has_column]
        numbers.is_reported[at] = 1
        return numbers
