"""Commands as functions that `command` marks, and options that several of them have.

Every program of ours understands -h, --help and --version.
"""

import errno
import functools
import inspect
import math
import os
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, get_type_hints

import typer

from aos_protocol import __version__
from aos_runtime.sandbox.support import trust_documents

HELP_NAMES: dict[str, Any] = {"help_option_names": ["-h", "--help"]}
"""The context settings of a program."""


def _print_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"aos {__version__}")
        raise typer.Exit


_WEEK_S = 7 * 86_400.0

Version = Annotated[
    bool, typer.Option("--version", help="Print the version and end", callback=_print_version, is_eager=True)
]


def finite(value: float | None) -> float | None:
    """The callback of an option with a number: nan, which passes every range, and infinity are none."""
    if value is not None and not math.isfinite(value):
        raise typer.BadParameter(f"{value} is not a finite number")
    return value


def seconds(*names: str, least: float, help: str) -> Any:
    """Gives an option with a time of `least` seconds, and of a week at most."""
    return typer.Option(*names, min=least, max=_WEEK_S, callback=finite, help=help)


def writable(path: Path | None) -> Path | None:
    """Refuses a file that cannot be written: the work before that may take hours."""
    if path is None:
        return None
    if not path.parent.is_dir():
        raise typer.BadParameter(f"there is no folder {path.parent}")
    if path.is_dir():
        raise typer.BadParameter(f"{path} is a folder")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise typer.BadParameter(f"{path} cannot be written")
    try:
        if path.is_char_device() and not path.samefile("/dev/null"):
            with path.open("wb", buffering=0) as device:
                _ = device.isatty() or device.write(b"\0")
        elif (disk := os.statvfs(path.parent)).f_blocks and not disk.f_bavail:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    except OSError as error:
        raise typer.BadParameter(f"{path} cannot be written: {error.strerror}") from None
    return path


def all_writable(paths: list[Path] | None) -> list[Path] | None:
    """Refuses files of which one cannot be written."""
    for path in paths or ():
        writable(path)
    return paths


def _trust(is_trusted: bool) -> bool:
    if is_trusted:
        trust_documents()
    return is_trusted


TrustDocuments = Annotated[
    bool,
    typer.Option(
        "--trust-documents",
        help="Run the documents' code also where the kernel cannot confine it",
        callback=_trust,
        is_eager=True,
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON")]
Mission = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Of a system that stays: instead of the last")
]

# --- which mission ---

Connect = Annotated[
    str, typer.Option("--connect", metavar="ENDPOINT", help="Where a system's bus listens, on any machine")
]
Robot = Annotated[str, typer.Option("--robot", help="The robot's name, with --connect")]
Run = Annotated[
    Path | None,
    typer.Option(
        "--run", metavar="DIR", help="A run directory, or a file of `aos export`; else what runs, or the last"
    ),
]
OneRun = Annotated[
    Path | None,
    typer.Argument(metavar="RUN", help="A run directory, or a file of `aos export`; else the last"),
]
ChosenRuns = Annotated[
    list[Path] | None,
    typer.Argument(metavar="RUN...", help="Run directories, or a folder of them; else the last run"),
]
Runs = Annotated[
    Path | None,
    typer.Option(
        "--runs", metavar="DIR", help="Only runs in this folder; else ./runs and what runs anywhere"
    ),
]


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
