"""The values of mission parameters as an engine child gets them: arguments of its start.

Each is `name=value`, with the value as `StateReader` in state_text.hpp reads it.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping

from aos_language.mission_parameters import ParameterLeaf

__all__ = ["parameter_arguments"]


def parameter_arguments(leaves: Mapping[str, ParameterLeaf], values: Mapping[str, str]) -> tuple[str, ...]:
    """The arguments for values in their canonical spelling; each is that of a leaf."""
    return tuple(
        f"{name}={' '.join(map(str, _numbers(leaves[name], text)))}" for name, text in values.items()
    )


def _numbers(leaf: ParameterLeaf, text: str) -> Iterator[int]:
    if leaf.values:
        yield leaf.values.index(text)
    elif leaf.type == "bool":
        yield int(text == "true")
    elif leaf.type == "string":
        characters = struct.unpack(f"{len(text.encode())}b", text.encode())
        yield from (len(characters), *characters)
    elif leaf.type in ("float", "double"):
        yield from struct.unpack("<q", struct.pack("<d", float(text)))
    else:
        yield int(text)
