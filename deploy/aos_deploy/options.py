"""What every program of ours understands on its command line: -h, --help and --version."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from aos_protocol import __version__

__all__ = ["HELP_NAMES", "Version"]

HELP_NAMES: dict[str, Any] = {"help_option_names": ["-h", "--help"]}
"""The context settings of a program."""


def _print_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"aos {__version__}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", help="Print the version and end", callback=_print_version, is_eager=True)
]
