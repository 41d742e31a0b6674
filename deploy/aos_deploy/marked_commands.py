"""Commands as functions that `command` marks, and how they come into a program."""

import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeVar

import typer

F = TypeVar("F", bound=Callable[..., None])


def command(epilog: str, name: str | None = None, **how: Any) -> Callable[[F], F]:
    """Marks a function as a command. Its example stands below its help; `how` is for typer."""

    def marked(function: F) -> F:
        function.__dict__["command"] = {"epilog": epilog, "name": name, **how}
        return function

    return marked


def add_commands(app: typer.Typer, module: ModuleType) -> None:
    """Adds the commands and the groups of a module, in their order there."""
    for found in vars(module).values():
        if isinstance(found, typer.Typer):
            app.add_typer(found)
        elif inspect.isfunction(found) and found.__module__ == module.__name__ and "command" in vars(found):
            app.command(**vars(found)["command"])(found)
