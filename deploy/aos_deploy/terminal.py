"""The terminal: a console that does without styles where NO_COLOR is set, and progress of long work.

rich is imported where something is drawn: that takes an eighth of a command that prints lines alone.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.timed_lines import TimedLines

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn
    from rich.table import Table

_PIPED_COLUMNS = 1000


def console(*, stderr: bool = False, is_wide: bool = False) -> Console:
    """Standard output or standard error. With NO_COLOR not even bold or dim is left (see no-color.org).

    What `is_wide` is cut nowhere where nobody has said how wide it may be: in a pipe or a file.
    """
    from rich.console import Console

    shown = Console(stderr=stderr, color_system=None if os.environ.get("NO_COLOR") else "auto")
    if is_wide and not shown.is_terminal and not os.environ.get("COLUMNS"):
        shown.width = _PIPED_COLUMNS
    return shown


def print_table(table: Table) -> None:
    """Prints a table; in a terminal that is narrower, its rows as lines."""
    out = console(is_wide=True)
    wide = out.options.update(max_width=_PIPED_COLUMNS)
    if out.width >= out.measure(table, options=wide).maximum:
        out.print(table)
        return
    out.print(*filter(None, (column.header for column in table.columns)))
    for row, cells in zip(table.rows, zip(*(each.cells for each in table.columns), strict=True), strict=True):
        out.print(*filter(None, cells), style=row.style, highlight=False)


def write_what_fits(stream: object) -> None:
    """Has a stream write a question mark for each letter that its encoding does not have, as Latin-1 and
    the lines of tables."""
    if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
        is_unicode = stream.encoding.lower().startswith("utf")
        stream.reconfigure(errors="backslashreplace" if is_unicode else "replace")


def progress(*columns: ProgressColumn) -> Progress:
    """A bar on standard error that goes away in the end; lines there where that is no terminal."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from aos_deploy.told_progress import ToldProgress

    usual = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    shown = console(stderr=True)
    if not shown.is_terminal:
        return ToldProgress()
    return Progress(*(columns or usual), console=shown, transient=True)


@contextmanager
def interruption_told(text: Callable[[], str]) -> Iterator[None]:
    """Ends a command at Ctrl-C with the text on standard error, and with the exit code of an interruption."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(f"aos: {text()}", err=True)
        raise typer.Exit(ExitCode.INTERRUPTED) from None


@contextmanager
def waiting(what: str, *, first_s: float | None = None) -> Iterator[Callable[[str], None]]:
    """Shows what is waited for, and for how long, where the work has no steps to count.

    What is yielded takes how far the work is, as text. Where standard error is no terminal, lines there tell
    it: the first after `first_s`, which is LINE_EVERY_S by default, then every LINE_EVERY_S.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        lines = TimedLines(what, first_s)
        with lines.ticking():
            yield lines.tell
        return
    from rich.progress import SpinnerColumn, TextColumn, TimeElapsedColumn

    with progress(SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn()) as shown:
        task = shown.add_task(what, total=None)
        yield lambda text: shown.update(task, description=f"{what}: {text}")
