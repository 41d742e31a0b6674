"""The text of a fault at the terminal."""

from __future__ import annotations

import typer

from aos_protocol.diagnostics import render
from aos_protocol.errors import AosError

__all__ = ["print_fault"]


def print_fault(command: str, error: AosError) -> None:
    """Prints on stderr every diagnostic with its place, then what it comes to, unless that is the same
    again."""
    for diagnostic in error.diagnostics:
        typer.echo(render(diagnostic), err=True)
    if not any(diagnostic.message in error.message for diagnostic in error.diagnostics):
        typer.echo(f"{command}: {error}", err=True)
