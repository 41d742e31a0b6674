"""The values of mission parameters as an engine child gets them: arguments of its start.

Each is `name=value`, with the value as `StateReader` in state_text.hpp reads it.
"""

from collections.abc import Mapping

from aos_language.mission_parameters import ParameterLeaf
from aos_solver.child.lines.local_values import numbers_of


def parameter_arguments(leaves: Mapping[str, ParameterLeaf], values: Mapping[str, str]) -> tuple[str, ...]:
    """The arguments for values in their canonical spelling; each is that of a leaf."""
    return tuple(
        f"{name}={' '.join(map(str, numbers_of(_value(leaves[name], text))))}"
        for name, text in values.items()
    )


def _value(leaf: ParameterLeaf, text: str) -> int | float | str:
    if leaf.values:
        return leaf.values.index(text)
    if leaf.type == "bool":
        return text == "true"
    if leaf.type == "string":
        return text
    return float(text) if leaf.type in ("float", "double") else int(text)
