"""Mission parameters: what an environment declares of them, and the values that a mission gives them.

A parameter is one value, or a structure of values, whose parts can be set by themselves: `place.x` is a field
of a compound type, `wanted[Soda]` an element of an array over an enum. Each part that holds one value is a
*leaf*. A leaf that nobody sets has what the documents give it by default.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from aos_language.findings import Findings
from aos_language.reading.document import array_type
from aos_protocol.diagnostics import Span
from aos_protocol.documents import EnumType, Environment, MissionValue, StateVariable
from aos_protocol.errors import DocumentError
from aos_protocol.spelling import quoted

OPTION = "--set"
"""Values are written `NAME=VALUE` behind it."""

_INTEGERS = {
    "int": 32, "int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64,
    "long": 64, "long long": 64, "short": 16,
}  # fmt: skip
"""The whole numbers that a parameter may be, with their bits."""
_KINDS = {"bool": "true or false", "float": "a number", "double": "a number", "string": "a text"}
_INTEGER = re.compile(r"[+-]?\d+")
_REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
MAX_TEXT_BYTES = 62
"""The longest text that a state variable holds."""


class ParameterLeaf(msgspec.Struct, frozen=True):
    """A value that can be set: its name, its type, and the values of an enum."""

    name: str
    type: str
    values: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """The type for people."""
        if self.values:
            return f"one of {', '.join(self.values)}"
        return _KINDS.get(self.type, f"a whole number of {_INTEGERS.get(self.type, 0)} bits")

    def canonical(self, text: str) -> str | None:
        """The value in one spelling; None where it is none of the type's."""
        text = text if self.type == "string" else text.strip()
        if self.values:
            return text if text in self.values else None
        if self.type == "bool":
            return text if text in ("true", "false") else None
        if self.type == "string":
            return text if len(text.encode()) <= MAX_TEXT_BYTES and text.isprintable() else None
        if self.type in _INTEGERS:
            limit = 2 ** (_INTEGERS[self.type] - 1)
            return str(int(text)) if _INTEGER.fullmatch(text) and -limit <= int(text) < limit else None
        if not _REAL.fullmatch(text) or not math.isfinite(float(text)):
            return None
        return repr(float(text))


def parameter_leaves(environment: Environment) -> dict[str, ParameterLeaf]:
    """All that can be set, by name, in the order of the declarations."""
    leaves = _Leaves(environment)
    return {leaf.name: leaf for variable in environment.variables for leaf in leaves.of(variable)}


class _Leaves:
    """The parts of parameters, by the types of an environment."""

    def __init__(self, environment: Environment) -> None:
        self._enums: Mapping[str, EnumType] = {enum.name: enum for enum in environment.enums}
        self._compounds = {compound.name: compound for compound in environment.compounds}

    def of(self, variable: StateVariable) -> Iterator[ParameterLeaf]:
        if variable.is_mission_parameter and not variable.key_types:
            array = f"[{variable.index_enum}]" if variable.is_array else ""
            yield from self._below(variable.name, f"{variable.type}{array}", ())

    def _below(self, name: str, kind: str, outer: tuple[str, ...]) -> Iterator[ParameterLeaf]:
        element, is_array, index = array_type(kind)
        if is_array:
            for value in self._enums[index].values if index in self._enums else ():
                yield from self._below(f"{name}[{value}]", element, outer)
        elif kind in self._enums:
            yield ParameterLeaf(name, kind, self._enums[kind].values)
        elif kind in self._compounds and kind not in outer:
            for field in self._compounds[kind].fields:
                yield from self._below(f"{name}.{field.name}", field.type, (*outer, kind))
        elif kind in _KINDS or kind in _INTEGERS:
            yield ParameterLeaf(name, kind)


def mission_value_of_option(text: str) -> MissionValue:
    """`target=alice` as a command has it; DocumentError AOS146 if it is not written so."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        hint = f"Write it as {OPTION} target=alice"
        raise DocumentError(f"{text!r} sets no mission parameter", code="AOS146", hint=hint)
    return mission_value(name.strip(), value)


def mission_value(name: str, text: str) -> MissionValue:
    """The value of a parameter that no file sets. What is wrong with it is told at the option with it."""
    return MissionValue(name, text, Span(f"{OPTION} {name}={text}"))


def declared_values(
    values: Iterable[MissionValue], leaves: Mapping[str, ParameterLeaf]
) -> tuple[MissionValue, ...]:
    """Those of parts that are declared, for documents that are not the ones that the values are set for."""
    paths = {_path(name) for name in leaves}
    return tuple(value for value in values if _path(value.name) in paths)


def checked_values(
    values: Iterable[MissionValue], leaves: Mapping[str, ParameterLeaf], findings: Findings
) -> dict[str, str]:
    """The values in one spelling by the names of their leaves, the last one for each.

    AOS146 for a parameter that is not declared, with the nearest that is, and for a value that it cannot
    have.
    """
    by_path = {_path(name): leaf for name, leaf in leaves.items()}
    found: dict[str, str] = {}
    for value in values:
        leaf = by_path.get(_path(value.name))
        if leaf is None:
            _report_unknown(value, leaves, findings)
        elif (text := leaf.canonical(value.text)) is None:
            message = f"{leaf.name} cannot be {value.text!r}: it is {leaf.kind}"
            findings.unknown(value.text, leaf.values, message, value.span, code="AOS146")
        else:
            found[leaf.name] = text
    return found


def usable_values(values: Sequence[MissionValue], leaves: Mapping[str, ParameterLeaf]) -> dict[str, str]:
    """The same; DocumentError AOS146 that says all that is wrong, for whoever answers a command."""
    findings = Findings()
    found = checked_values(values, leaves, findings)
    if findings.has_errors:
        wrong = findings.diagnostics
        message = "; ".join(diagnostic.message for diagnostic in wrong)
        hint = next((diagnostic.hint for diagnostic in wrong if diagnostic.hint), "")
        raise DocumentError(message, code="AOS146", hint=hint, diagnostics=wrong)
    return found


def _path(name: str) -> str:
    """`wanted[Soda]` and `wanted.Soda` are the same."""
    return re.sub(r"\s*\[\s*(\w+)\s*\]", r".\1", name.strip())


def _report_unknown(value: MissionValue, leaves: Mapping[str, ParameterLeaf], findings: Findings) -> None:
    parts = [leaf for name, leaf in leaves.items() if _path(name).startswith(f"{_path(value.name)}.")]
    if parts:
        message = f"{value.name} has parts, which are set one by one"
        findings.error("AOS146", message, value.span, f"They are {quoted(leaf.name for leaf in parts)}")
        return
    message = f"unknown mission parameter `{value.name}`"
    known = f"The mission parameters are {quoted(leaves)}" if leaves else "The documents declare none"
    findings.unknown(value.name, leaves, message, value.span, known, code="AOS146")
