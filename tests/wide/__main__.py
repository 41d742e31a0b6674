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
import random
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .arms import arms, arms_rule
from .delivery import delivery, delivery_rule
from .gauges import Gauges, gauges, gauges_rule
from .leaving import LEAVING, LEAVING_RULES, LEAVING_SIZES, LEAVING_WORLDS
from .lock import Lock, lock, lock_rule
from .missions import Played, played
from .photo import Photo, photo, photo_rule
from .pipe import Pipe, pipe, pipe_rule
from .problems import PROBLEMS, SIZES
from .rescue import Rescue, rescue, rescue_rule
from .rules import RULES
from .towers import Towers, towers, towers_rule
from .upkeep import UPKEEP, UPKEEP_RULES, UPKEEP_SIZES
from .world import World

_STEPS = 120  # at most, in a mission

_SINGLE = {
    "arms": arms,
    "delivery": delivery,
    "rescue": rescue,
    "lock": lock,
    "towers": towers,
    "photo": photo,
    "gauges": gauges,
    "pipe": pipe,
}
_BUNDLES = PROBLEMS | UPKEEP | LEAVING | _SINGLE
_SIZES = (
    SIZES
    | UPKEEP_SIZES
    | LEAVING_SIZES
    | {"arms": 8, "delivery": 6, "rescue": 3, "lock": 5, "towers": 10, "photo": 12, "gauges": 8, "pipe": 40}
)
_RULES = (
    RULES
    | UPKEEP_RULES
    | LEAVING_RULES
    | {
        "arms": arms_rule,
        "delivery": delivery_rule,
        "rescue": rescue_rule,
        "lock": lock_rule,
        "towers": towers_rule,
        "photo": photo_rule,
        "gauges": gauges_rule,
        "pipe": pipe_rule,
    }
)
_WORLDS: dict[str, Callable[[int, random.Random], World]] = LEAVING_WORLDS | {
    "rescue": Rescue,
    "lock": Lock,
    "towers": Towers,
    "photo": Photo,
    "gauges": Gauges,
    "pipe": Pipe,
}


def write(folder: Path, problem: str, size: int) -> Path:
    """Writes the bundle of a problem into a folder of its own and returns that."""
    bundle = folder / f"{problem}{size}"
    bundle.mkdir(parents=True, exist_ok=True)
    for name, text in _BUNDLES[problem](size).items():
        (bundle / name).write_text(text)
    return bundle


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
        for problem, size in _SIZES.items():
            write(Path(arguments.problem[1]), problem, arguments.size or size)
        return
    for problem in arguments.problem or _BUNDLES:
        seeds = range(arguments.seed, arguments.seed + arguments.runs)
        with tempfile.TemporaryDirectory() as folder:
            bundle, rule = Path(problem), ""
            if problem in _BUNDLES:
                size = arguments.size or _SIZES[problem]
                mean, error = ruled(problem, size, 200, arguments.seed)
                bundle, rule = write(Path(folder), problem, size), f"rule {mean:.1f} +- {error:.1f}, "
                if problem in _WORLDS:
                    mean, error = at_random(problem, size, 200, arguments.seed)
                    rule += f"random {mean:.1f} +- {error:.1f}, "
            found = asyncio.run(played(bundle, arguments.planner, arguments.time, seeds, _STEPS))
        print(f"{bundle.name}: {rule}{_text(found)}", flush=True)


def ruled(problem: str, size: int, missions: int, seed: int) -> tuple[float, float]:
    """The mean discounted return of a rule over missions, and its standard error."""
    return _mean([_RULES[problem](size, random.Random(f"{seed}/{mission}")) for mission in range(missions)])


def at_random(problem: str, size: int, missions: int, seed: int) -> tuple[float, float]:
    """The mean discounted return of random actions over missions, and its standard error."""
    worlds = [_WORLDS[problem](size, random.Random(f"{seed}/{mission}")) for mission in range(missions)]
    return _mean([world.play_at_random() for world in worlds])


def _mean(returns: list[float]) -> tuple[float, float]:
    return float(np.mean(returns)), float(np.std(returns, ddof=1) / len(returns) ** 0.5)


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
