"""Commands as functions that `command` marks, and how they come into a program."""

import functools
import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any, get_type_hints

import typer


def command(
    epilog: str, name: str | None = None, **how: Any
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Marks a function as a command. Its example stands below its help; `how` is for typer."""

    def marked(function: Callable[..., None]) -> Callable[..., None]:
        function = grouped(function)
        function.__dict__["command"] = {"epilog": epilog, "name": name, **how}
        return function

    return marked


def grouped(function: Callable[..., None]) -> Callable[..., None]:
    """A command with the fields of a NamedTuple as options in place of each parameter that is of its type."""
    signature = inspect.signature(function, eval_str=True)
    groups: dict[str, Any] = {}
    parameters: list[inspect.Parameter] = []
    for own in signature.parameters.values():
        if not hasattr(own.annotation, "_fields"):
            parameters.append(own.replace(kind=inspect.Parameter.KEYWORD_ONLY))
            continue
        groups[own.name] = own.annotation
        hints, defaults = get_type_hints(own.annotation, include_extras=True), own.annotation._field_defaults
        for name in own.annotation._fields:
            default = defaults.get(name, inspect.Parameter.empty)
            option = inspect.Parameter(
                name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hints[name]
            )
            parameters.append(option)
    if not groups:
        return function

    @functools.wraps(function)
    def with_groups(**given: Any) -> None:
        made = {
            name: kind(**{field: given.pop(field) for field in kind._fields}) for name, kind in groups.items()
        }
        function(**made, **given)

    with_groups.__dict__["__signature__"] = signature.replace(parameters=parameters)
    return with_groups


def add_commands(app: typer.Typer, module: ModuleType) -> None:
    """Adds the commands and the groups of a module, in their order there."""
    for found in vars(module).values():
        if isinstance(found, typer.Typer):
            app.add_typer(found)
        elif inspect.isfunction(found) and found.__module__ == module.__name__ and "command" in vars(found):
            app.command(**vars(found)["command"])(found)
