"""The text of a fault at the terminal."""

import typer

from aos_protocol.diagnostics import render
from aos_protocol.errors import AosError
from aos_protocol.spelling import printable

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
