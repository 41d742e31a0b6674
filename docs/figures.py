"""Measures the figures of pages and pastes them there: `python docs/figures.py checking speed`.

A page of docs/lab has one table of figures, between `<!-- figures -->` and `<!-- end -->`. The table's
head says when it was measured, at which commit and on which machine, and the table has what the commands
print. `checking` takes some minutes and `speed` ten, longer beside other work. `--show` prints and
changes no page.
"""

import argparse
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

from aos_lab.bench.rows import this_machine
from aos_lab.experiments.results import commit_of

DOCS = Path(__file__).resolve().parent


class Row(NamedTuple):
    """A measurement. Its result is the last `lines` lines that the command prints."""

    what: str
    command: tuple[str, ...]
    target: str
    lines: int = 1


CHECKING = (
    Row("135 seeded mistakes in 9 bundles of all dialects", ("python", "tests/mistakes.py"), "135, 128", 3),
    Row(
        "2,000 mutated documents, read, lowered and emitted",
        ("python", "tests/mutate_documents.py", "--count", "2000", "--seed", "1"),
        "no crash, each below 1 s", 20,
    ),
)  # fmt: skip
SPEED = ("aos", "bench", "--quick", "--metric", "steps", "--metric", "simulations", "--markdown")


def measured(rows: tuple[Row, ...]) -> str:
    """A table of rows, measured now."""
    machine = this_machine("", 0, 0.0)
    where = f"{machine.processor}, {machine.cores} cores, load {machine.load:.1f}"
    lines = [
        f"{machine.date}, commit {commit_of(DOCS)}, {where}.",
        "",
        "| What | Command | Result | Target |",
        "| --- | --- | --- | --- |",
    ]
    for row in rows:
        printed = [line.strip() for line in _printed(row.command).splitlines() if line.strip()]
        result = ", ".join(printed[-row.lines :])
        lines.append(f"| {row.what} | `{' '.join(row.command)}` | {result} | {row.target} |")
    return "\n".join(lines)


def speed() -> str:
    """Returns the output of `SPEED`, which has a head of its own, below the command and the commit.

    What two threads do says something only while two cores are idle, so it is left out.
    """
    lines = [line for line in _printed(SPEED).strip().splitlines() if "two threads" not in line]
    return "\n".join([f"`{' '.join(SPEED)}`, commit {commit_of(DOCS)}.", *lines])


FIGURES = {"checking": partial(measured, CHECKING), "speed": speed}


def _printed(command: tuple[str, ...]) -> str:
    """Runs a command of the checkout and returns its output; `python` and `aos` are those that this runs
    with."""
    program = str(Path(sys.executable).with_name(command[0]))
    done = subprocess.run(
        [program, *command[1:]], cwd=DOCS.parent, stdout=subprocess.PIPE, text=True, check=True
    )
    return done.stdout


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "pages", nargs="+", choices=sorted(FIGURES), metavar="PAGE", help=" or ".join(FIGURES)
    )
    parser.add_argument("--show", action="store_true", help="print the tables and change no page")
    options = parser.parse_args()
    for name in options.pages:
        table = FIGURES[name]()
        if options.show:
            sys.stdout.write(table + "\n")
        else:
            paste(table, DOCS / "lab" / f"{name}.md")
    return 0


def paste(table: str, page: Path) -> None:
    """Puts a table in the place of the page's figures."""
    before, begin, rest = page.read_text(encoding="utf-8").partition("<!-- figures -->\n")
    _, end, after = rest.partition("<!-- end -->")
    if not begin or not end:
        raise SystemExit(f"{page.relative_to(DOCS.parent)} has no place for figures")
    page.write_text(f"{before}{begin}{table}\n\n{end}{after}", encoding="utf-8")
    sys.stdout.write(f"{page.relative_to(DOCS.parent)} written\n")


if __name__ == "__main__":
    sys.exit(main())
