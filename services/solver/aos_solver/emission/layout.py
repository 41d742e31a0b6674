"""The layout of a model's state: what tells whether a variable is the same in another model."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping

import msgspec

from aos_solver.emission.program import Loop, Piece, Program, Section, SpecialState, Statement, Variable

_NAME = re.compile(r"[A-Za-z_]\w*")
_VECTOR = "aos::Vector<"
_CAPACITY = re.compile(r", \d+$")


class Layout(msgspec.Struct, frozen=True):
    """The variables that a saved state holds, each with its shape, in the order of the documents.

    A shape is the type with all that it is made of: fields of compounds, values of enums, lengths of arrays.
    The capacity of a vector is none of it: that depends on all code. `held` are those that a state holds, so
    without the constants. `fixed` are those that nothing but the initial belief sets. `spendable` are the
    special states that count once: their code, and the bit that says that one is spent.
    """

    shapes: dict[str, str] = {}
    held: frozenset[str] = frozenset()
    fixed: frozenset[str] = frozenset()
    spendable: tuple[tuple[str, int], ...] = ()

    def common_with(self, new: Layout) -> Common:
        """Returns what a state of this layout and of a new one have in common."""
        kept = tuple(
            name for name, shape in new.shapes.items() if name in new.held and self.shapes.get(name) == shape
        )
        bits: dict[int, int] = {}
        rest = list(new.spendable)
        for code, bit in self.spendable:
            same = next((each for each in rest if each[0] == code), None)
            if same is not None:
                rest.remove(same)
                bits[bit] = same[1]
        # A constant of before never changed either.
        fixed = tuple(name for name in kept if name in new.fixed and name in self.fixed)
        return Common(kept, fixed, bits)


class Common(msgspec.Struct, frozen=True):
    """The variables of two layouts that have the same name and shape, and the bits of what may be spent.

    `fixed` are those of the variables that nothing but the initial belief sets in either model.
    """

    kept: tuple[str, ...]
    fixed: tuple[str, ...]
    bits: Mapping[int, int]

    def spent(self, before: int) -> int:
        """The bits of the new layout for the bits that were set in the old one."""
        return sum(new for old, new in self.bits.items() if before & old)


def layout_of(program: Program) -> Layout:
    """The layout of a program's state."""
    parts = _parts(program)
    variables = saved_variables(program)
    return Layout(
        shapes={variable.name: _shape(variable.type, parts) for variable in variables},
        held=frozenset(variable.name for variable in program.particle),
        fixed=frozenset(v.name for v in variables if v.is_fixed or v.is_constant),
        spendable=tuple((_code_of(each), each.bit) for each in program.special_states if each.bit),
    )


def saved_variables(program: Program) -> tuple[Variable, ...]:
    """Returns the variables of a saved state, whatever the particle of this very model holds."""
    return tuple(
        v
        for v in program.variables
        if not v.is_mission_parameter and not (v.is_constant and v.is_parameter_value)
    )


def _parts(program: Program) -> dict[str, str]:
    """The shapes of the project's own types."""
    parts = {enum.name: f"{enum.name}{json.dumps(enum.values)}" for enum in program.enums}
    for compound in program.compounds:  # Each stands behind those that it holds.
        fields = [f"{field.name}: {_shape(field.type, parts)}" for field in compound.fields]
        parts[compound.name] = f"{compound.name}{{{', '.join(fields)}}}"
    return parts


def _shape(type_text: str, parts: Mapping[str, str]) -> str:
    return _NAME.sub(lambda name: parts.get(name[0], name[0]), _without_capacities(type_text))


def _without_capacities(type_text: str) -> str:
    before, vector, rest = type_text.partition(_VECTOR)
    if not vector:
        return type_text
    depth = 1
    for end, character in enumerate(rest):
        depth += (character == "<") - (character == ">")
        if depth == 0:
            inner = _CAPACITY.sub("", _without_capacities(rest[:end]))
            return f"{before}{vector}{inner}{_without_capacities(rest[end:])}"
    return type_text


def _code_of(special: SpecialState) -> str:
    if special.condition is not None:
        return special.condition.snippet.code
    return "\n".join(piece.snippet.code for piece in _pieces(special.section))


def _pieces(section: Section | None) -> Iterator[Piece]:
    for statement in section.statements if section is not None else ():
        yield from _pieces_in(statement)


def _pieces_in(statement: Statement | None) -> Iterator[Piece]:
    if isinstance(statement, Piece):
        yield statement
    elif isinstance(statement, Loop):
        for part in (statement.condition, statement.body, statement.inner):
            yield from _pieces_in(part)
