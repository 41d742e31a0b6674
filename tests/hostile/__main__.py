"""Plays hostile documents in `aos lint`, in pushes and in missions, and tells which promises did not hold.

    python -m tests.hostile --times 50 --log attempts.tsv

With a log the rounds that it has are not played again, so that an interrupted campaign goes on.
"""

import argparse
import shutil
import signal
import sys
import tempfile
from pathlib import Path

from tests.hostile.attempt import TOLD_S, WAYS, Playground
from tests.hostile.log import Log, summary, who_plays
from tests.hostile.said import import_commands

from aos_deploy.places import cache_dir
from aos_runtime.processes.parent import adopt_orphans
from aos_runtime.sandbox.support import sandbox_text


def main() -> int:
    options = _options()
    adopt_orphans()
    import_commands()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))
    log = Log(options.log, who_plays())
    # Not a TemporaryDirectory: the first command that is forked from here would remove it at its exit.
    folder = Path(tempfile.mkdtemp(prefix="aos-hostile-"))
    try:
        playground = Playground(folder, cache_dir(), fresh=options.fresh)
        for number in range(1, options.times + 1):

            def wanted(kind: str, name: str, way: str, number: int = number) -> bool:
                is_asked = way in options.ways and options.only in f"{kind} {name}"
                return is_asked and not log.has(number, kind, name, way)

            for attempt in playground.round(f"{who_plays()} {number}", wanted):
                log.add(number, attempt)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(sandbox_text())
    print(summary(log.lines, TOLD_S))
    return int(any(line.faults for line in log.lines))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("--times", type=int, default=1, help="repetitions of each attempt")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=WAYS)
    parser.add_argument("--only", default="", help="attempts whose kind and name contain this")
    parser.add_argument("--log", type=Path, help="a file with a line for each attempt, to go on from")
    parser.add_argument("--fresh", action="store_true", help="compile each attempt, start each command anew")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
