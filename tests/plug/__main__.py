"""Figures about documents that change while a mission runs, a line for each part and for each fault.

  python -m tests.plug                    all parts, as `make plug` does
  python -m tests.plug truth              one part; `--help` names them and their options

Exit code 1: a target was missed.
"""

import argparse
import asyncio
import logging
import os
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Coroutine, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from .changes import KINDS
from .pushes import Played, played
from .shelf import interleaved
from .truth import examined_problems

PUSHES_OF_ONE = 25
"""The pushes of one mission."""
UNDISTURBED_STEPS = 200
EXACT, KEPT, STANDARD_ERRORS = 1e-9, 1e-12, 3.0
LATER_S = 0.05


class Part(NamedTuple):
    """A part: its title, what it counts and how many of them, and its measurement, true where all is well."""

    title: str
    counted: str
    count: int
    measure: Callable[[int, int], Coroutine[None, None, bool]]


async def _truth(models: int, seed: int) -> bool:
    logging.disable(logging.CRITICAL)
    found = []
    async for each in examined_problems(models, seed):
        found.append(each)
        if each.replay > EXACT or each.kept > KEPT or abs(each.drawn) > STANDARD_ERRORS:
            _say(f"  {each}")
    replay, kept = max(each.replay for each in found), max(each.kept for each in found)
    drawn, new = max(abs(each.drawn) for each in found), max(each.new for each in found)
    _say(
        f"truth: {len(found)} models, {sum(each.foreign for each in found)} steps that new documents lack; "
        f"off by at most {replay:.1e} (replay), {drawn:.2f} standard errors (replay by particles), "
        f"{kept:.1e} (projection), {new:.1e} (the new variable's initial belief)"
    )
    return replay <= EXACT and kept <= KEPT and drawn <= STANDARD_ERRORS


async def _shelf(interleavings: int, seed: int) -> bool:
    logging.disable(logging.CRITICAL)
    taken: Counter[str] = Counter()
    faulty = 0
    for number in range(seed, seed + interleavings):
        result = await interleaved(number)
        taken.update(result.taken)
        if result.faults:
            faulty += 1
            _say(f"  {number}: {result.faults[0]}")
    _say(f"shelf: {interleavings} interleavings, {faulty} with a fault; taken {dict(taken)}")
    return not faulty


async def _pushes(pushes: int, seed: int) -> bool:
    missions = []
    calm = await _mission(seed, (), UNDISTURBED_STEPS)
    chance = random.Random(seed)
    while (left := pushes - sum(len(mission.pushed) for mission in missions)) > 0:
        kinds = [chance.choice(KINDS) for _ in range(min(left, PUSHES_OF_ONE))]
        mission = await _mission(seed + len(missions), kinds, 0)
        missions.append(mission)
        if mission.faults:
            _say(f"  {mission.seed}: {'; '.join(mission.faults)}")
        if not mission.pushed:
            break
    pushed = [each for mission in missions for each in mission.pushed]
    disturbed = [seconds for mission in missions for seconds in mission.between_s]
    _say(
        f"pushes: {len(pushed)} in {len(missions)} missions, {sum(not each.is_accepted for each in pushed)} "
        f"refused; from outcome to decision {_times(disturbed)}, without pushes {_times(calm.between_s)}; "
        f"load {os.getloadavg()[0]:.1f}"
    )
    for kind in KINDS:
        used = [each.used_s for each in pushed if each.kind == kind and each.used_s is not None]
        _say(f"  {kind}: used after {_times(used)}")
    later_s = _share(disturbed, 0.95) - _share(calm.between_s, 0.95)
    return not any(mission.faults for mission in missions) and later_s <= LATER_S


async def _mission(seed: int, kinds: Sequence[str], undisturbed: int) -> Played:
    with tempfile.TemporaryDirectory(prefix="aos-plug-") as folder:
        return await played(Path(folder) / "mission", seed, kinds, undisturbed)


def _times(seconds: Sequence[float]) -> str:
    if not seconds:
        return "-"
    return (
        " / ".join(f"{_share(seconds, share):.3f}" for share in (0.5, 0.95, 1.0)) + " s (median, 95 %, most)"
    )


def _share(seconds: Sequence[float], share: float) -> float:
    ordered = sorted(seconds)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


def _say(text: str):
    print(text, flush=True)


PARTS: Mapping[str, Part] = {
    "truth": Part("beliefs of new documents", "models", 200, _truth),
    "shelf": Part("the shelf of models", "interleavings", 10_000, _shelf),
    "pushes": Part("pushes into missions", "pushes", 500, _pushes),
}


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.plug", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="part")
    for name, part in PARTS.items():
        command = commands.add_parser(name, help=part.title)
        command.add_argument(f"--{part.counted}", type=int, default=part.count, dest="count")
        command.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    if chosen.part is not None:
        return _missed(chosen.part, chosen)
    return max([_missed(name, parser.parse_args([name])) for name in PARTS])


def _missed(name: str, options: argparse.Namespace) -> int:
    return int(not asyncio.run(PARTS[name].measure(options.count, options.seed)))


if __name__ == "__main__":
    sys.exit(main())
