"""Low-level values: what is behind the `anyValue`s of the state, which to the model are only there or not.

They begin as the documents' defaults, names of low-level constants. A response's rule may put new ones in
their place. They belong to state variables; an activation finds them under the parameters that stand for
those variables.
"""

import copy
import logging
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from aos_language.cpp.snippets import Access, read_cpp
from aos_middleware.workers.values import put
from aos_protocol.documents import CompoundType, Environment, Project
from aos_protocol.messages import Activate, Outcome

_log = logging.getLogger("aos.middleware")


def default_constants(project: Project) -> dict[str, str]:
    """The constant behind each `anyValue` that has one by default, by name: `shelf.place` to `___shelf`."""
    low_level, environment = project.low_level, project.environment
    names = frozenset(constant.name for constant in low_level.constants) if low_level is not None else ()
    compounds = {compound.name: compound for compound in environment.compounds}
    return {path: name for path, name in _defaults(environment, compounds) if name in names}


def _defaults(environment: Environment, compounds: Mapping[str, CompoundType]) -> Iterator[tuple[str, str]]:
    """Paths with the text of what is assigned to them, in the order of effect."""
    for variable in environment.variables:
        yield from _field_defaults(variable.name, variable.type, compounds)
        if variable.default_value is not None:
            yield variable.name, variable.default_value.code.strip("; \n")
        if variable.default_code is None:
            continue
        cpp = read_cpp(variable.default_code.code)
        for mention in cpp.mentions:
            value = mention.assigned
            if mention.path[0] == "state" and mention.access is Access.WRITE and value is not None:
                yield ".".join(mention.path[1:]), cpp.text(value).strip()


def _field_defaults(
    path: str, type_name: str, compounds: Mapping[str, CompoundType], outer: tuple[str, ...] = ()
) -> Iterator[tuple[str, str]]:
    if type_name not in compounds or type_name in outer:
        return
    for field in compounds[type_name].fields:
        yield from _field_defaults(f"{path}.{field.name}", field.type, compounds, (*outer, type_name))
        if field.default is not None:
            yield f"{path}.{field.name}", field.default.code.strip("; \n")


def assigned_variables(assigned: Mapping[str, Any], request: Activate) -> dict[str, Any]:
    """Returns what a rule gives, by paths that may start with a parameter, as values of state variables."""
    values: dict[str, Any] = {}
    for path, value in assigned.items():
        first, dot, rest = path.removeprefix("state.").partition(".")
        if first in request.parameters and first not in request.variables:
            _log.warning("%s: %s stands for no state variable, nothing is assigned", request.skill, first)
            continue
        values[f"{request.variables.get(first, first)}{dot}{rest}"] = value
    return values


class LowLevelValues:
    """The values that responses have put behind the state's `anyValue`s, as plain data."""

    def __init__(self, outcomes: Iterable[Outcome] = ()) -> None:
        self._assigned: dict[str, Any] = {}
        for outcome in outcomes:
            self.take(outcome)

    def take(self, outcome: Outcome) -> None:
        """Takes over what came with a response."""
        self._assigned.update(outcome.assigned)

    def arguments(
        self, request: Activate, constants: Mapping[str, str]
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """The parameters with the names of constants where these stand, and the assigned values.

        The latter are given by their paths from the parameters.
        """
        parameters = copy.deepcopy(request.parameters)
        for path, name in _by_parameter(request.variables, constants):
            put(parameters, path, name)
        return parameters, dict(_by_parameter(request.variables, self._assigned))


def _by_parameter(variables: Mapping[str, str], values: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for parameter, variable in variables.items():
        for path, value in values.items():
            first, dot, rest = path.partition(".")
            if first == variable:
                yield f"{parameter}{dot}{rest}", value
