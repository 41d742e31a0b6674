"""Figures about documents that change while a mission runs: beliefs, the shelf of models, and pushes.

`truth` lets documents with a variable more take over random models of the exam. `shelf` plays random
interleavings of pushes, decisions, faults, cancels and ends. `pushes` plays real missions with pushes at
random moments, and compares them with a mission without.
"""

import argparse
import asyncio
import logging
import os
import random
import tempfile
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path

from .changes import KINDS
from .pushes import Played, Pushed, played
from .shelf import interleaved
from .truth import Examined, examined_problems

PUSHES_OF_ONE = 25
"""The pushes of one mission."""
UNDISTURBED_STEPS = 200
EXACT, KEPT, STANDARD_ERRORS = 1e-9, 1e-12, 3.0


def add_truth_options(parser: argparse.ArgumentParser):
    parser.add_argument("--models", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)


def measure_truth(options: argparse.Namespace) -> int:
    """Returns 1 where a belief is not what it should be."""
    logging.disable(logging.CRITICAL)
    return int(not asyncio.run(_truth(options.models, options.seed)))


def add_shelf_options(parser: argparse.ArgumentParser):
    parser.add_argument("--interleavings", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)


def measure_shelf(options: argparse.Namespace) -> int:
    """Returns 1 where an engine was asked after its end or left, or a revision lost."""
    logging.disable(logging.CRITICAL)
    return int(not asyncio.run(_shelf(options.interleavings, options.seed)))


def add_push_options(parser: argparse.ArgumentParser):
    parser.add_argument("--pushes", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)


def measure_pushes(options: argparse.Namespace) -> int:
    """Returns 1 where a mission ended by a push, a push was not used, or decisions came late."""
    has_missed = not asyncio.run(_pushes(options.pushes, options.seed))
    _say(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    return int(has_missed)


async def _truth(models: int, seed: int) -> bool:
    found = []
    async for each in examined_problems(models, seed):
        found.append(each)
        if each.replay > EXACT or each.kept > KEPT or abs(each.drawn) > STANDARD_ERRORS:
            _say(f"  {each}")
    replay, kept = max(each.replay for each in found), max(each.kept for each in found)
    far = sum(abs(each.drawn) > STANDARD_ERRORS for each in found)
    _say(
        f"truth: {len(found)} models, {sum(each.foreign for each in found)} steps that the new documents lack"
    )
    _say(f"  replay against the exact posterior: at most {replay:.1e} apart")
    _say(f"  replay by particles: {far} models beyond 3 standard errors, the most {_most_drawn(found):.2f}")
    _say(f"  projection: what both have moved by at most {kept:.1e}")
    _say(f"  projection: the new variable is at most {_most_new(found):.1e} off the initial belief")
    return replay <= EXACT and kept <= KEPT and far == 0


def _most_drawn(found: Sequence[Examined]) -> float:
    return max(abs(each.drawn) for each in found)


def _most_new(found: Sequence[Examined]) -> float:
    return max(each.new for each in found)


async def _shelf(interleavings: int, seed: int) -> bool:
    taken: Counter[str] = Counter()
    faulty = 0
    for number in range(seed, seed + interleavings):
        result = await interleaved(number)
        taken.update(result.taken)
        if result.faults:
            faulty += 1
            _say(f"  {number}: {result.faults[0]}")
    ways = ", ".join(f"{count} by {way}" for way, count in sorted(taken.items()))
    _say(f"shelf: {interleavings} interleavings, {faulty} with a fault; {ways}")
    return not faulty


async def _pushes(pushes: int, seed: int) -> bool:
    missions = []
    calm = await _mission(seed, (), UNDISTURBED_STEPS)
    chance = random.Random(seed)
    while (left := pushes - sum(len(mission.pushed) for mission in missions)) > 0:
        kinds = [chance.choice(KINDS) for _ in range(min(left, PUSHES_OF_ONE))]
        mission = await _mission(seed + len(missions), kinds, 0)
        missions.append(mission)
        _say(f"  {mission.seed}: {mission.steps} steps; {'; '.join(mission.faults) or 'all well'}")
        if not mission.pushed:
            break
    pushed = [each for mission in missions for each in mission.pushed]
    refused = sum(not each.is_accepted for each in pushed)
    steps = sum(mission.steps for mission in missions)
    _say(f"pushes: {len(pushed)} in {len(missions)} missions of {steps} steps, {refused} refused")
    by_kind: dict[str, list[Pushed]] = defaultdict(list)
    for each in pushed:
        by_kind[each.kind].append(each)
    for kind, all_of_kind in sorted(by_kind.items()):
        used = [each.used_s for each in all_of_kind if each.used_s is not None]
        ways = Counter(each.by for each in all_of_kind if each.by)
        _say(f"  {kind:17} {len(all_of_kind):4}  used after {_times(used)}  {dict(ways)}")
    accepted = [each for each in pushed if each.used_s is not None]
    _say(f"  accepted until used: {_times([each.used_s - each.answered_s for each in accepted])}")
    disturbed = [seconds for mission in missions for seconds in mission.between_s]
    _say(f"  from outcome to decision, without the search: {_times(disturbed)}")
    _say(f"  the same without pushes:                      {_times(calm.between_s)}")
    later_s = _share(disturbed, 0.95) - _share(calm.between_s, 0.95)
    _say(f"  later by {1000 * later_s:.0f} ms (95 %)")
    return not any(mission.faults for mission in missions) and later_s <= 0.05


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
