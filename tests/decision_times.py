"""Plays missions of bundles and prints what they return, and what decisions and belief updates take.

  python -m tests.decision_times deploy/bundles/bench/lightdark --runs 10
  python -m tests.decision_times greenhouse inspection        # problems of tests.wide

All times are processor time of the engine's process, so that other work on the machine counts little: half
of them are within the first number, 95 % within the second, and the third is the longest. *Search* is what
the budget is for. *Preparation* is lists, values and first bounds before it. *Beside* is the rest of a
decision's command, such as what is told. An *update* is all that the process does from one decision to the
next.
"""

from __future__ import annotations

import argparse
import asyncio
import tempfile
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from tests.wide.bundles import USUAL_SIZES, write
from tests.wide.missions import Played, played

_COUNTED = 0.95


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tests.decision_times",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("bundle", nargs="+", help="a folder, or the name of a problem of tests.wide")
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--time", type=float, default=0.1, help="the budget of a decision in seconds")
    parser.add_argument("--steps", type=int, default=120, help="at most, in a mission")
    parser.add_argument("--planner", default="auto")
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.runs)
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.bundle:
            bundle = write(Path(folder), name, USUAL_SIZES[name]) if name in USUAL_SIZES else Path(name)
            found = asyncio.run(played(bundle, arguments.planner, arguments.time, seeds, arguments.steps))
            print(_report(bundle.name, found), flush=True)


def _report(name: str, found: Played) -> str:
    returns = " ".join(f"{value:.1f}" for value in found.returns)
    lines = [f"{name}: {found.mean:.1f} ± {found.error:.1f} in {len(found.returns)} missions: {returns}"]
    by_planner = defaultdict(list)
    for decision in found.decisions:
        by_planner[decision.planner].append(decision)
    groups = {"all": found.decisions, **(by_planner if len(by_planner) > 1 else {})}
    for planner, decisions in groups.items():
        parts = {
            "search": [decision.search_s for decision in decisions],
            "preparation": [decision.preparation_s for decision in decisions],
            "beside": [decision.beside_s for decision in decisions],
        }
        told = "; ".join(f"{part} {_times(times)}" for part, times in parts.items())
        lines.append(f"  {planner}, {len(decisions)} decisions: {told}")
    lines.append(f"  updates {_times(found.updates_s)}")
    return "\n".join(lines)


def _times(times_s: Sequence[float]) -> str:
    """The median, the 95th percentile and the longest of some times in ms."""
    if not times_s:
        return "none"
    ranked = sorted(1000 * time_s for time_s in times_s)
    half, most = (ranked[int(share * (len(ranked) - 1))] for share in (0.5, _COUNTED))
    return f"{half:.0f} {most:.0f} {ranked[-1]:.0f} ms"


if __name__ == "__main__":
    main()
