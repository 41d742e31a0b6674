"""Plays hostile documents in `aos lint`, in pushes and in missions, and tells which promises did not hold.

python -m tests.hostile --times 50
"""

import argparse
import shutil
import signal
import sys
import tempfile
from pathlib import Path

from tests.hostile.attempt import TOLD_S, WAYS, Attempt, Playground
from tests.hostile.log import line, summary, who_plays
from tests.hostile.said import import_commands

from aos_deploy.places import cache_dir
from aos_runtime.processes.parent import adopt_orphans
from aos_runtime.sandbox.support import sandbox_text


def main() -> int:
    options = _options()
    adopt_orphans()
    import_commands()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))
    attempts: list[Attempt] = []

    def wanted(kind: str, name: str, way: str) -> bool:
        return way in options.ways and options.only in f"{kind} {name}"

    # Not a TemporaryDirectory: the first command that is forked from here would remove it at its exit.
    folder = Path(tempfile.mkdtemp(prefix="aos-hostile-"))
    try:
        playground = Playground(folder, cache_dir(), fresh=options.fresh)
        for number in range(1, options.times + 1):
            for attempt in playground.round(f"{who_plays()} {number}", wanted):
                attempts.append(attempt)
                print(line(number, attempt), flush=True)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(sandbox_text())
    print(summary(attempts, TOLD_S))
    return int(any(attempt.faults for attempt in attempts))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("--times", type=int, default=1, help="repetitions of each attempt")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=WAYS)
    parser.add_argument("--only", default="", help="attempts whose kind and name contain this")
    parser.add_argument("--fresh", action="store_true", help="compile each attempt, start each command anew")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
