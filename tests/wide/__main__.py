"""Measures planners on problems whose states cannot be listed, beside rules by hand.

python -m tests.wide                      # all problems, 8 missions each, 0.1 s of processor time a decision
python -m tests.wide clutter --size 60 --runs 30
python -m tests.wide write FOLDER         # writes the bundles
"""

import argparse
import asyncio
import random
import tempfile
from pathlib import Path

import numpy as np
from tests.exam.summary import times_text

from .apart_rules import APART_RULES
from .bundles import USUAL_SIZES, write
from .inspection import inspection_rule
from .missions import Played, played
from .rules import RULES
from .upkeep import UPKEEP_RULES

_STEPS = 120  # at most, in a mission

_RULES = RULES | APART_RULES | UPKEEP_RULES | {"inspection": inspection_rule}


def main() -> None:
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
        for problem, size in USUAL_SIZES.items():
            write(Path(arguments.problem[1]), problem, arguments.size or size)
        return
    for problem in arguments.problem or USUAL_SIZES:
        size = arguments.size or USUAL_SIZES[problem]
        rule, rule_error = ruled(problem, size, 200, arguments.seed)
        seeds = range(arguments.seed, arguments.seed + arguments.runs)
        with tempfile.TemporaryDirectory() as folder:
            bundle = write(Path(folder), problem, size)
            found = asyncio.run(played(bundle, arguments.planner, arguments.time, seeds, _STEPS))
        print(f"{problem} {size}: rule {rule:.1f} +- {rule_error:.1f}, {_text(found)}", flush=True)


def ruled(problem: str, size: int, missions: int, seed: int) -> tuple[float, float]:
    """The mean discounted return of a rule over missions, and its standard error."""
    returns = [_RULES[problem](size, random.Random(f"{seed}/{mission}")) for mission in range(missions)]
    return float(np.mean(returns)), float(np.std(returns, ddof=1) / missions**0.5)


def _text(found: Played) -> str:
    assert found.first is not None
    told = found.first.best
    return (
        f"{' and '.join(sorted(found.planners))} {found.mean:.1f} +- {found.error:.1f} "
        f"(told {told.q:.1f} +- {told.stderr:.1f}); {times_text(found.times_s)}; "
        f"preparations took {max(found.preparations_s):.1f} s at most"
    )


if __name__ == "__main__":
    main()
