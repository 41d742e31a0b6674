"""Values of a YAML file into a typed structure: every unknown key, missing key and wrong type in one run."""

from __future__ import annotations

import difflib
import types
import typing
from collections.abc import Iterable
from typing import Any, TypeVar

import msgspec

from aos_protocol.diagnostics import Span
from aos_deploy.yaml_source import Findings, YamlList, YamlMap, YamlNode, YamlScalar

__all__ = ["nearest", "read_structure"]

S = TypeVar("S", bound=msgspec.Struct)

_KINDS = {str: "a text", int: "a whole number", float: "a number", bool: "true or false"}


def read_structure(node: YamlMap, kind: type[S], findings: Findings, prefix: str = "") -> S | None:
    """An instance of `kind`, whose fields are the keys; None if that is not possible, with findings why.

    Understands scalars with `msgspec.Meta` limits, literals, optional values, structures, tuples and mappings
    of such. `prefix` is the dotted path of the node, for the messages.
    """
    fields = {field.name: field for field in msgspec.structs.fields(kind)}
    hints = typing.get_type_hints(kind, include_extras=True)
    for key, where in node.keys.items():
        if key not in fields:
            findings.error("AOS102", f"unknown key {prefix}{key}", where, nearest(key, fields))
    values: dict[str, Any] = {}
    is_whole = True
    for name, field in fields.items():
        if name in node.entries:
            value, is_good = _read(node.entries[name], hints[name], findings, f"{prefix}{name}")
            values[name] = value
            is_whole &= is_good
        elif field.required:
            findings.error("AOS105", f"the key {prefix}{name} is missing", node.span)
            is_whole = False
    return kind(**values) if is_whole else None


def nearest(word: str, known: Iterable[str]) -> str:
    """A hint that names the known word closest to a wrong one, or all of them."""
    known = sorted(known)
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.6)
    return f"Did you mean {close[0]}?" if close else f"Known are {', '.join(known)}"


def _read(node: YamlNode, kind: Any, findings: Findings, path: str) -> tuple[Any, bool]:
    """The value, and whether it is good."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin in (types.UnionType, typing.Union):
        if isinstance(node, YamlScalar) and node.value is None:
            return None, True
        (kind,) = (argument for argument in arguments if argument is not types.NoneType)
        return _read(node, kind, findings, path)
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        if isinstance(node, YamlMap):
            structure = read_structure(node, kind, findings, f"{path}.")
            return structure, structure is not None
        return _refuse(findings, path, "a mapping of keys to values", node.span)
    if origin is tuple:
        if isinstance(node, YamlList):
            read = [_read(item, arguments[0], findings, f"{path}[{i}]") for i, item in enumerate(node.items)]
            return tuple(value for value, _ in read), all(is_good for _, is_good in read)
        return _refuse(findings, path, "a list", node.span)
    if origin is dict:
        if isinstance(node, YamlMap):
            entries = {
                key: _read(item, arguments[1], findings, f"{path}.{key}")
                for key, item in node.entries.items()
            }
            values = {key: value for key, (value, _) in entries.items()}
            return values, all(is_good for _, is_good in entries.values())
        return _refuse(findings, path, "a mapping of keys to values", node.span)
    return _read_scalar(node, kind, findings, path)


def _read_scalar(node: YamlNode, kind: Any, findings: Findings, path: str) -> tuple[Any, bool]:
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Literal:
        expected = " or ".join(str(argument) for argument in arguments)
        if isinstance(node, YamlScalar) and node.value in arguments:
            return node.value, True
        return _refuse(findings, path, expected, node.span)
    base = arguments[0] if origin is typing.Annotated else kind
    if not isinstance(node, YamlScalar):
        return _refuse(findings, path, _KINDS[base], node.span)
    try:
        return msgspec.convert(node.value, kind), True
    except msgspec.ValidationError as error:
        limit = str(error).rpartition("`")[2].strip()
        is_limit = isinstance(node.value, int | float if base is float else base) and limit
        expected = f"{_KINDS[base]} {limit}" if is_limit else _KINDS[base]
        return _refuse(findings, path, expected, node.span)


def _refuse(findings: Findings, path: str, expected: str, where: Span) -> tuple[None, bool]:
    findings.error("AOS106", f"{path} is not {expected}", where)
    return None, False
