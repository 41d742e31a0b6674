"""Figures about replays and studies, each part measured by a command.

  python -m tests.study                    all parts, as `make study` does
  python -m tests.study replay --runs 16   one part

Exit code 1: a target was missed.
"""

import argparse
import asyncio
import sys
import tempfile
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path

from . import asked, replays

Measure = Callable[[int, Path], Awaitable[bool]]

PARTS: Mapping[str, tuple[str, Measure, int]] = {
    "replay": ("missions of 8 models, replayed", replays.measure, 100),
    "undisturbed": ("missions with and without somebody who asks", asked.measure_undisturbed, 100),
    "flips": ("beliefs at which exact choices change", asked.measure_flips, 40),
    "intervals": ("the same for choices by POMCP, and their margins", asked.measure_intervals, 40),
}


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.study",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("part", nargs="?", choices=PARTS, help="only this part")
    parser.add_argument("--runs", type=int, help="how many missions or cases")
    parser.add_argument("--cache", type=Path, help="the folder of compiled models; by default a new one")
    chosen = parser.parse_args()
    is_well = True
    with tempfile.TemporaryDirectory() as folder:
        for name in [chosen.part] if chosen.part else PARTS:
            title, measure, runs = PARTS[name]
            print(f"--- {title}", flush=True)
            is_well &= asyncio.run(measure(chosen.runs or runs, chosen.cache or Path(folder)))
    return 0 if is_well else 1


if __name__ == "__main__":
    sys.exit(main())
