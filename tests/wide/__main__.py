"""Measures planners on problems whose states cannot be listed, beside rules by hand.

python -m tests.wide                      # all problems, 8 missions each, 0.1 s of processor time a decision
python -m tests.wide clutter --size 60 --runs 30
python -m tests.wide shared/bench/kitchen12    # a bundle in a folder
python -m tests.wide write FOLDER         # writes the bundles

Times are processor time of the engine's process: half of them are within the first number, 95 % within the
second, and the third is the longest. The budget is for the *search*; lists and values before it are
*preparation*. An *update* is all that the process does between two decisions.
"""

import argparse
import asyncio
import tempfile
from pathlib import Path

from .kept import KEPT
from .missions import Played, played

_STEPS = 120  # at most, in a mission


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", nargs="*", help="names of problems, or `write FOLDER`")
    parser.add_argument("--size", type=int)
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--time", type=float, default=0.1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--planner", default="auto")
    arguments = parser.parse_args()
    if arguments.problem[:1] == ["write"]:
        for name, problem in KEPT.items():
            size = arguments.size or problem.size
            problem.write(Path(arguments.problem[1]) / f"{name}{size}", size)
        return
    for name in arguments.problem or KEPT:
        seeds = range(arguments.seed, arguments.seed + arguments.runs)
        with tempfile.TemporaryDirectory() as folder:
            bundle, rule = Path(name), ""
            if name in KEPT:
                problem, size = KEPT[name], arguments.size or KEPT[name].size
                bundle = problem.write(Path(folder) / f"{name}{size}", size)
                rule = f"{problem.by_hand}, " if size == problem.size else ""
            found = asyncio.run(played(bundle, arguments.planner, arguments.time, seeds, _STEPS))
        print(f"{bundle.name}: {rule}{_text(found)}", flush=True)


def _text(found: Played) -> str:
    assert found.first is not None
    told = found.first.best
    returns = " ".join(f"{value:.1f}" for value in found.returns)
    lines = [f"{found.mean:.1f} +- {found.error:.1f} (told {told.q:.1f} +- {told.stderr:.1f}): {returns}"]
    for planner in sorted({decision.planner for decision in found.decisions}):
        decisions = [decision for decision in found.decisions if decision.planner == planner]
        searches = _times([decision.search_s for decision in decisions])
        preparations = _times([decision.preparation_s for decision in decisions])
        lines.append(f"{len(decisions)} by {planner}: search {searches}, preparation {preparations}")
    searches = _times([decision.search_s for decision in found.decisions])
    lines.append(f"all: search {searches}; updates {_times(found.updates_s)}")
    return "\n  ".join(lines)


def _times(times_s: list[float]) -> str:
    ranked = sorted(1000 * time_s for time_s in times_s) or [0.0]
    half, most = (ranked[int(share * (len(ranked) - 1))] for share in (0.5, 0.95))
    return f"{half:.0f} {most:.0f} {ranked[-1]:.0f} ms"


if __name__ == "__main__":
    main()
