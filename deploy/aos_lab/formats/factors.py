"""Conditional tables over variables: as entries, and with an action chosen ready to be looked up."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import chain

import msgspec
import numpy as np

from aos_solver.offline.explicit_model import Floats, Integers

ANY = -1
EACH = -2

_MAX_CELLS = 50_000_000
_USUAL_CELLS = 1_000_000
"""Tables beyond this are kept sparse if their entries are single cells."""

Columns = Mapping[str, Integers]
Outcomes = tuple[Integers, Integers, Floats]
"""Rows, values and probabilities of what a distribution gives for several rows of parents."""


class Variable(msgspec.Struct, frozen=True, dict=True):
    """A variable with its values: a state before or after the step, an action, an observation.

    That of a state after the step names the `earlier` one.
    """

    name: str
    values: tuple[str, ...]
    line: int = 0
    earlier: str = ""

    @cached_property
    def numbers(self) -> dict[str, int]:
        return {value: number for number, value in enumerate(self.values)}


class Entry(msgspec.Struct, frozen=True):
    """A value index, ANY or EACH for every variable of the table; `cells` has an axis for each EACH."""

    pattern: tuple[int, ...]
    cells: Floats


class DenseFactor(msgspec.Struct, frozen=True):
    """A table over the variables that matter, in this order; the last axis of a distribution is its own."""

    axes: tuple[str, ...]
    cells: Floats

    def values(self, columns: Columns, rows: int) -> Floats:
        """The cell for every row of the columns."""
        return np.broadcast_to(self.cells[tuple(columns[axis] for axis in self.axes)], rows)

    def outcomes(self, columns: Columns, rows: int) -> Outcomes:
        """Returns the outcomes of the distribution for every row of its parents."""
        parents = tuple(columns[axis] for axis in self.axes[:-1])
        chances = self.cells[parents] if parents else np.tile(self.cells, (rows, 1))
        row, value = np.nonzero(chances)
        return row, value, chances[row, value]


class SparseFactor(msgspec.Struct, frozen=True):
    """The same for a large distribution with few cells: those of a code of the parents stand together."""

    axes: tuple[str, ...]
    sizes: tuple[int, ...]
    codes: Integers
    cell_values: Integers
    chances: Floats

    def values(self, columns: Columns, rows: int) -> Floats:
        """Sparse factors are distributions."""
        raise TypeError("a distribution is drawn from")

    def outcomes(self, columns: Columns, rows: int) -> Outcomes:
        """Returns the outcomes of the distribution for every row of its parents."""
        code = np.zeros(rows, dtype=np.int64)
        for axis, size in zip(self.axes[:-1], self.sizes[:-1], strict=True):
            code = code * size + columns[axis]
        begin, end = np.searchsorted(self.codes, code), np.searchsorted(self.codes, code, "right")
        lengths = end - begin
        cell = np.repeat(begin - np.r_[0, np.cumsum(lengths)[:-1]], lengths) + np.arange(int(lengths.sum()))
        return np.repeat(np.arange(rows), lengths), self.cell_values[cell], self.chances[cell]


Factor = DenseFactor | SparseFactor


class Table(msgspec.Struct, frozen=True, dict=True):
    """`P(variables[-1] | the others)`, or a reward over all of them. Later entries override earlier ones.

    `place` is its line and column in the file.
    """

    variables: tuple[Variable, ...]
    entries: list[Entry]
    is_distribution: bool
    place: str

    @property
    def own(self) -> str:
        return self.variables[-1].name

    @cached_property
    def _by_first_choice(self) -> dict[int, list[tuple[int, Entry]]]:
        """The entries with their places, by the choice of the first variable, which mostly is the action."""
        found: dict[int, list[tuple[int, Entry]]] = {}
        for place, entry in enumerate(self.entries):
            found.setdefault(entry.pattern[0], []).append((place, entry))
        return found

    def given(self, fixed: Mapping[str, int]) -> Factor:
        """The table with some variables fixed, and without those that no entry looks at.

        MemoryError where it is too large once it is written out.
        """
        entries = self._fitting(fixed)
        last = len(self.variables) - 1
        matters = [
            variable.name not in fixed
            and (
                any(entry.pattern[place] != ANY for entry in entries)
                or (self.is_distribution and place == last)
            )
            for place, variable in enumerate(self.variables)
        ]
        kept = [place for place, is_kept in enumerate(matters) if is_kept]
        cell_count = np.prod([len(self.variables[place].values) for place in kept], dtype=float)
        if self.is_distribution and cell_count > _USUAL_CELLS and _are_cells(entries, kept):
            return self._sparse(entries, kept)
        if cell_count > _MAX_CELLS:
            raise MemoryError
        return self._dense(entries, matters, fixed)

    def _fitting(self, fixed: Mapping[str, int]) -> list[Entry]:
        """The entries that agree with the fixed values, in their order."""
        first = self.variables[0].name
        if first in fixed:
            groups = [self._by_first_choice.get(choice, []) for choice in (fixed[first], ANY, EACH)]
            entries = [entry for _, entry in sorted(chain(*groups), key=lambda placed: placed[0])]
        else:
            entries = self.entries
        if len(fixed) == (first in fixed):
            return entries
        return [entry for entry in entries if _fits(entry.pattern, self.variables, fixed)]

    def _dense(self, entries: list[Entry], matters: list[bool], fixed: Mapping[str, int]) -> DenseFactor:
        kept = [variable for variable, is_kept in zip(self.variables, matters, strict=True) if is_kept]
        cells = np.zeros([len(variable.values) for variable in kept])
        for entry in entries:
            where: list[int | slice] = []
            values, axis = entry.cells, 0
            for variable, choice, is_kept in zip(self.variables, entry.pattern, matters, strict=True):
                if choice == EACH and not is_kept:
                    values = np.take(values, fixed[variable.name], axis=axis)
                elif choice == EACH:
                    axis += 1
                if is_kept:
                    where.append(slice(None) if choice in (ANY, EACH) else choice)
            # An axis of length one for ANY, so that the values spread over it.
            spread = [
                slice(None) if choice == EACH else None
                for choice, is_kept in zip(entry.pattern, matters, strict=True)
                if is_kept and choice in (ANY, EACH)
            ]
            cells[tuple(where)] = values[tuple(spread)] if spread else values
        return DenseFactor(tuple(variable.name for variable in kept), cells)

    def _sparse(self, entries: list[Entry], kept: list[int]) -> SparseFactor:
        sizes = tuple(len(self.variables[place].values) for place in kept)
        cells: dict[tuple[int, int], float] = {}
        for entry in entries:
            code = 0
            for place, size in zip(kept[:-1], sizes[:-1], strict=True):
                code = code * size + entry.pattern[place]
            cells[code, entry.pattern[kept[-1]]] = float(entry.cells)
        ordered = sorted((code, value, chance) for (code, value), chance in cells.items() if chance > 0)
        codes, values, chances = zip(*ordered, strict=True) if ordered else ((), (), ())
        axes = tuple(self.variables[place].name for place in kept)
        return SparseFactor(
            axes,
            sizes,
            np.array(codes, dtype=np.int64),
            np.array(values, dtype=np.int64),
            np.array(chances, dtype=float),
        )


def _fits(pattern: Sequence[int], variables: Sequence[Variable], fixed: Mapping[str, int]) -> bool:
    return all(
        choice in (ANY, EACH, fixed.get(variable.name, choice))
        for choice, variable in zip(pattern, variables, strict=True)
    )


def _are_cells(entries: list[Entry], kept: list[int]) -> bool:
    return all(
        entry.cells.ndim == 0 and min(entry.pattern[place] for place in kept) >= 0 for entry in entries
    )
