"""Figures about documents that change while a mission runs, each part measured by a command.

  python -m tests.plug                    all parts, as `make plug` does
  python -m tests.plug truth              one part; `--help` names them and their options

Exit code 1: a target was missed.
"""

import argparse
import sys
from collections.abc import Callable, Mapping
from typing import NamedTuple

from . import takeovers


class Part(NamedTuple):
    """A part: its title, its options, and its measurement, which returns 1 where a target was missed."""

    title: str
    add_options: Callable[[argparse.ArgumentParser], None]
    measure: Callable[[argparse.Namespace], int]


PARTS: Mapping[str, Part] = {
    "truth": Part("beliefs of new documents", takeovers.add_truth_options, takeovers.measure_truth),
    "shelf": Part("the shelf of models", takeovers.add_shelf_options, takeovers.measure_shelf),
    "pushes": Part("pushes into missions", takeovers.add_push_options, takeovers.measure_pushes),
}


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.plug", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="part")
    for name, part in PARTS.items():
        part.add_options(commands.add_parser(name, help=part.title))
    chosen = parser.parse_args()
    if chosen.part is not None:
        return PARTS[chosen.part].measure(chosen)
    has_missed = 0
    for name, part in PARTS.items():
        print(f"--- {part.title}")
        has_missed |= part.measure(parser.parse_args([name]))
    return has_missed


if __name__ == "__main__":
    sys.exit(main())
