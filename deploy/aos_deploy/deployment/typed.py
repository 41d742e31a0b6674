"""Values of a YAML file into a typed structure: every unknown key, missing key and wrong type in one run."""

import math
import types
import typing
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import msgspec
from msgspec import UNSET

from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlNode, YamlScalar
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span

S = TypeVar("S", bound=msgspec.Struct)

_KINDS = {str: "a text", int: "a whole number", float: "a number", bool: "true or false"}


def read_structure(node: YamlMap, kind: type[S], findings: Findings, prefix: str = "") -> S | None:
    """An instance of `kind`, whose fields are the keys.

    What is wrong is found, and left at its default, so that the rest can be checked on; None where a required
    value is missing or wrong. Understands scalars with `msgspec.Meta` limits, literals, optional values,
    structures, tuples and mappings of such, and `Any`. `prefix` is the dotted path of the node, for the
    messages.
    """
    fields = {field.name: field for field in msgspec.structs.fields(kind)}
    hints = typing.get_type_hints(kind, include_extras=True)
    for key, where in node.keys.items():
        if key not in fields:
            message = f"unknown key {prefix}{key}"
            findings.unknown(key, fields, message, where, known_names(fields), code="AOS102")
    values: dict[str, Any] = {}
    for name, field in fields.items():
        if name in node.entries:
            value = _read(node.entries[name], hints[name], findings, f"{prefix}{name}")
            if value is not UNSET:
                values[name] = value
        elif field.required:
            findings.error("AOS105", f"the key {prefix}{name} is missing", node.span)
    if any(field.required and name not in values for name, field in fields.items()):
        return None
    return kind(**values)


def known_names(names: Iterable[str]) -> str:
    """The hint that lists all names there are."""
    return f"Known are {', '.join(sorted(names))}"


def plain_value(node: YamlNode) -> Any:
    """Returns the value of a node as lists, dicts and scalars."""
    if isinstance(node, YamlMap):
        return {key: plain_value(item) for key, item in node.entries.items()}
    if isinstance(node, YamlList):
        return [plain_value(item) for item in node.items]
    return node.value


def _read(node: YamlNode, kind: Any, findings: Findings, path: str) -> Any:
    """The value, or UNSET where it is wrong as a whole; wrong items of a collection are left out."""
    if kind is Any:
        return plain_value(node)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin in (types.UnionType, typing.Union):
        if isinstance(node, YamlScalar) and node.value is None:
            return None
        (kind,) = (argument for argument in arguments if argument is not types.NoneType)
        return _read(node, kind, findings, path)
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        if not isinstance(node, YamlMap):
            return _refuse(findings, path, "a mapping of keys to values", node.span)
        structure = read_structure(node, kind, findings, f"{path}.")
        return UNSET if structure is None else structure
    if origin is tuple:
        if not isinstance(node, YamlList):
            return _refuse(findings, path, "a list", node.span)
        items = (_read(item, arguments[0], findings, f"{path}[{i}]") for i, item in enumerate(node.items))
        return tuple(item for item in items if item is not UNSET)
    if origin is dict:
        if not isinstance(node, YamlMap):
            return _refuse(findings, path, "a mapping of keys to values", node.span)
        values = {
            key: _read(item, arguments[1], findings, f"{path}.{key}") for key, item in node.entries.items()
        }
        return {key: value for key, value in values.items() if value is not UNSET}
    return _read_scalar(node, kind, findings, path)


def _read_scalar(node: YamlNode, kind: Any, findings: Findings, path: str) -> Any:
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    value = node.value if isinstance(node, YamlScalar) else UNSET
    if origin is typing.Literal:
        if any(type(value) is type(argument) and value == argument for argument in arguments):
            return value
        known = [str(argument) for argument in arguments]
        is_quoted = isinstance(value, str) and value in known
        said = f'the text "{value}"' if is_quoted else _shown(value)
        message = f"{path} is {said}; it must be {one_of(known)}"
        if is_quoted:
            findings.error("AOS106", message, node.span, "Write it without quotes")
            return UNSET
        findings.unknown(str(value), known, message, node.span, code="AOS106")
        return UNSET
    base = arguments[0] if origin is typing.Annotated else kind
    if isinstance(value, float) and not math.isfinite(value):
        findings.error("AOS106", f"{path} is {value}; it must be a finite number", node.span)
        return UNSET
    try:
        return msgspec.convert(value, kind)
    except msgspec.ValidationError as error:
        # "Expected `int` >= 1" for what is beyond a limit, "Expected `int`, got `str`" for another type.
        limit = str(error).rpartition("`")[2].strip() if ", got " not in str(error) else ""
        expected = f"{_KINDS[base]} {_limit_text(limit)}".strip()
        findings.error("AOS106", f"{path} is {_shown(value)}; it must be {expected}", node.span)
        return UNSET


def one_of(known: Sequence[str]) -> str:
    """Names to choose from: `pomcp, despot or auto`."""
    *others, last = known
    return f"{', '.join(others)} or {last}" if others else last


def _limit_text(limit: str) -> str:
    """A limit as msgspec writes it, in words: `<= 1.0` as `of at most 1`."""
    sign, _, number = limit.partition(" ")
    words = {"<=": "of at most", ">=": "of at least", ">": "above", "<": "below"}
    return f"{words[sign]} {number.removesuffix('.0')}" if sign in words else limit


def _shown(value: Any) -> str:
    """A value as it may be written in YAML; what is no scalar by its kind."""
    if value is UNSET:
        return "a list or a mapping"
    return "nothing" if value is None else str(value).lower() if isinstance(value, bool) else f"{value}"


def _refuse(findings: Findings, path: str, expected: str, where: Span) -> msgspec.UnsetType:
    findings.error("AOS106", f"{path} is not {expected}", where)
    return UNSET
