"""The types of local variables as far as model code can see them.

A mapping's local variables are Python values. Those with a type that C++ has too can tell more about the
state than the response does: in `state_given_observation` code by name, and by themselves where a state
variable has their name and type.
"""

import msgspec

from aos_protocol.documents import AbstractionMapping, Environment, StateVariable

OF_SKILL = ("__skill_status", "__skill_error")
"""The names by which rules read how a skill has failed."""

RESERVED_LOCAL_NAMES = frozenset({
    "CONSTANTS", "RESPONSE", "TOPICS", "__input", *OF_SKILL, "local_variables",
    "low_level_type", "observe", "parameters", "request", "stand_in", "stop_when",
})  # fmt: skip
"""No local variable can have these names: the generated module uses them, or is given them."""

ELEMENTS = ("bool", "int", "float", "double", "string")


class LocalType(msgspec.Struct, frozen=True):
    """One of bool, int, float, double, string; or an array of it."""

    element: str
    is_array: bool = False


def local_type(text: str) -> LocalType | None:
    """The type in a document's spelling: `int`, `int[]`, `vector<int>`; None for every other."""
    text = "".join(text.replace("std::", "").split())
    element = text
    if text.endswith("[]"):
        element = text.removesuffix("[]")
    elif text.startswith("vector<") and text.endswith(">"):
        element = text[len("vector<") : -1]
    return LocalType(element, element != text) if element in ELEMENTS else None


def local_type_text() -> str:
    """Returns the types that can be written, for hints."""
    return f"{', '.join(ELEMENTS)}, or an array such as int[]"


def reported_variables(mapping: AbstractionMapping, environment: Environment) -> tuple[str, ...]:
    """The local variables that tell the state variable of their name and type its value, in their order."""
    variables = {variable.name: _type_of(variable) for variable in environment.variables}
    return tuple(
        local.name
        for local in mapping.local_variables
        if (kind := local_type(local.type)) is not None and kind == variables.get(local.name)
    )


def _type_of(variable: StateVariable) -> LocalType | None:
    if variable.is_constant or variable.key_types:
        return None
    return local_type(f"{variable.type}[]" if variable.is_array else variable.type)
