"""The output of commands: findings, JSON, numbers of things."""

from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from pathlib import Path
from typing import TypeVar

import msgspec
import typer

from aos_protocol.diagnostics import Diagnostic, render
from aos_protocol.errors import AosError
from aos_protocol.spelling import printable

T = TypeVar("T")


def print_diagnostics(diagnostics: Iterable[Diagnostic]) -> None:
    """Each in its text form, on stdout."""
    for diagnostic in diagnostics:
        typer.echo(render(diagnostic))


def print_json(value: object) -> None:
    """A value as indented JSON, on stdout."""
    typer.echo(json_text(value))


def show(value: T, as_json: bool, for_people: Callable[[T], object]) -> None:
    """A command's result on stdout: as JSON, or as `for_people` prints it."""
    (print_json if as_json else for_people)(value)


def json_text(value: object) -> str:
    return msgspec.json.format(msgspec.json.encode(value), indent=2).decode()


def count(number: int, noun: str) -> str:
    """`1 error`, `2 errors`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def time_text(stamp_ns: int) -> str:
    """A time as ISO 8601 writes it, in whole seconds of UTC."""
    return datetime.fromtimestamp(stamp_ns / 1e9, UTC).isoformat(timespec="seconds")


def from_here(path: Path) -> Path:
    """The path as a user would write it."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


_MOST = 200
"""So many diagnostics are printed: a file of another form has one in each line."""


def print_fault(command: str, error: AosError) -> None:
    """Prints on stderr every diagnostic with its place, then what it comes to, unless that is the same
    again."""
    for diagnostic in error.diagnostics[:_MOST]:
        typer.echo(render(diagnostic), err=True)
    if (more := len(error.diagnostics) - _MOST) > 0:
        typer.echo(f"... and {more} more", err=True)
    if not any(diagnostic.message in error.message for diagnostic in error.diagnostics):
        typer.echo(printable(f"{command}: {error}"), err=True)
