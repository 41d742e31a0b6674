"""Measures the figures of pages and pastes them there: `python docs/figures.py speed`.

A page of docs/lab has one table of figures, between `<!-- figures -->` and `<!-- end -->`. The table has what
the command prints, with its date and machine, below the commit. `speed` takes ten minutes, longer beside
other work. `--show` prints and changes no page.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from aos_lab.experiments.results import commit_of

DOCS = Path(__file__).resolve().parent
SPEED = ("aos", "bench", "--quick", "--metric", "steps", "--metric", "simulations", "--markdown")


def speed() -> str:
    """Returns the output of `SPEED`, which has a head of its own, below the command and the commit.

    What two threads do says something only while two cores are idle, so it is left out.
    """
    program = str(Path(sys.executable).with_name(SPEED[0]))
    done = subprocess.run(
        [program, *SPEED[1:]], cwd=DOCS.parent, stdout=subprocess.PIPE, text=True, check=True
    )
    lines = [line for line in done.stdout.strip().splitlines() if "two threads" not in line]
    return "\n".join([f"`{' '.join(SPEED)}`, commit {commit_of(DOCS)}.", *lines])


FIGURES = {"speed": speed}


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
