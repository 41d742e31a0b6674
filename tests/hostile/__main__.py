"""Plays hostile documents in `aos lint`, in pushes and in missions, and tells which promises did not hold."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from pathlib import Path

from tests.hostile.attempt import TOLD_S, WAYS, Attempt, Playground, attempts

from aos_deploy.program import cache_dir
from aos_runtime.parent import adopt_orphans
from aos_runtime.sandbox.support import sandbox_text


def main() -> int:
    """Exit code 0 where every attempt was kept from what it reached for, and told."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    parser.add_argument("--times", type=int, default=1, help="repetitions of each attempt")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=WAYS)
    parser.add_argument("--only", default="", help="attempts whose kind and name contain this")
    options = parser.parse_args()
    print(sandbox_text())
    adopt_orphans()
    played: list[Attempt] = []
    with tempfile.TemporaryDirectory(prefix="aos-hostile-", ignore_cleanup_errors=True) as folder:
        playground = Playground(Path(folder), cache_dir())
        for _ in range(options.times):
            for kind, name, way in attempts(tuple(options.ways)):
                if options.only not in f"{kind} {name}":
                    continue
                attempt = playground.play(kind, name, way)
                played.append(attempt)
                told = "-" if attempt.told_s is None else f"{attempt.told_s:.1f} s"
                print(f"{kind} that {name}, {way}: {told}  {'; '.join(attempt.faults)}", flush=True)
    print(_summary(played))
    return int(any(attempt.faults for attempt in played))


def _summary(played: list[Attempt]) -> str:
    """One line: how many of each kind, how many broke a promise, and the latest word."""
    kinds = Counter(attempt.kind for attempt in played)
    counted = ", ".join(f"{count} of {kind}s" for kind, count in kinds.items())
    broken = sum(bool(attempt.faults) for attempt in played)
    told_s = [attempt.told_s for attempt in played if attempt.told_s is not None]
    early = sum(one_s <= TOLD_S for one_s in told_s)
    last_s = max(told_s, default=0.0)
    return (
        f"{counted}: {broken} broke a promise; {early} of {len(told_s)} were told within {TOLD_S:g} s, "
        f"the last after {last_s:.1f} s"
    )


if __name__ == "__main__":
    sys.exit(main())
