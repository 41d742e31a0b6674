"""Figures about missions that follow one another in one system.

`missions` plays many of them, compares some with systems of their own, and holds beliefs that are kept and
conditioned against enumeration.
"""

import argparse
import asyncio
import random
import tempfile
from pathlib import Path

from aos_deploy.history_check.files import check_run
from aos_deploy.places import cache_dir
from aos_runtime.disk.mission_folders import mission_folder

from .knowing import largest_difference
from .staying import Process, Stayed, decisions_of, fresh, stayed

BEGINS_S, GROWS_KB, EXACT = 1.0, 1024.0, 1e-12
SETTLED_AFTER = 20
"""Memory and descriptors are compared from this mission on."""


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--missions", type=int, default=300, help="missions in one system (300)")
    parser.add_argument(
        "--fresh", type=int, default=10, help="missions compared with systems of their own (10)"
    )
    parser.add_argument("--known", type=int, default=100, help="random conditions (100)")
    parser.add_argument("--seed", type=int, default=1)


def measure(options: argparse.Namespace) -> int:
    """Prints the figures; 1 where a target was missed."""
    return asyncio.run(_measured(options))


async def _measured(options: argparse.Namespace) -> int:
    has_missed = False
    if options.missions:
        has_missed |= await _many(options.missions, options.seed)
    if options.fresh:
        has_missed |= await _like_fresh(options.fresh)
    if options.known:
        has_missed |= await _known(options.known, options.seed)
    return int(has_missed)


async def _many(missions: int, seed: int) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        result = await stayed(Path(folder), missions, pushes=True, kills=True, chance=random.Random(seed))
        broken = check_run(result.run).violations
    unpushed = sorted(s for number, s in result.start_s.items() if number not in result.pushed)
    most_s = unpushed[-1]
    endings = {
        ending: sum(e.ending == ending for e in result.entries)
        for ending in {e.ending for e in result.entries}
    }
    print(f"{len(result.entries)} missions: {endings}")
    print(f"{len(result.pushed)} after a push, {len(result.killed)} with a killed engine")
    median_s = unpushed[len(unpushed) // 2]
    print(f"begins after start, documents unchanged: median {median_s:.3f} s, most {most_s:.3f} s")
    decided = sorted(result.decided_s.values())
    median_s = decided[len(decided) // 2]
    print(f"first decision after the begin: median {median_s:.3f} s, most {decided[-1]:.3f} s")
    has_missed = bool(result.faults) or bool(broken) or most_s > BEGINS_S or len(result.entries) != missions
    for fault in [*result.faults, *map(str, broken)]:
        print(f"  {fault}")
    for name, seen in result.processes.items():
        has_missed |= _grows(name, [process for process in seen if process.mission >= SETTLED_AFTER])
    return has_missed


def _grows(name: str, seen: list[Process]) -> bool:
    """Prints by how much a service has grown; a slope by least squares, so that no single moment decides."""
    if len(seen) < 2:
        return False
    kb = 100 * _slope([(each.mission, each.rss_kb) for each in seen])
    handles = seen[-1].descriptors - seen[0].descriptors
    now_mb = seen[-1].rss_kb / 1024
    print(f"{name:12} {now_mb:7.1f} MB, {kb / 1024:+.2f} MB in 100 missions, {handles:+d} descriptors")
    return kb > GROWS_KB or handles > 2


def _slope(points: list[tuple[int, int]]) -> float:
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / spread if spread else 0.0


async def _like_fresh(count: int) -> bool:
    alike = 0
    with tempfile.TemporaryDirectory() as folder:
        result: Stayed = await stayed(
            Path(folder) / "stays", count, pushes=False, kills=False, chance=random.Random(0)
        )
        for entry in result.entries:
            own = decisions_of(mission_folder(result.run, entry.number) / "journal.db")
            alone = await fresh(Path(folder) / f"fresh-{entry.seed}", entry.seed)
            alike += own == alone
            if own != alone:
                print(f"  mission {entry.number} differs from a system with seed {entry.seed}")
    print(f"decisions, observations and beliefs as in a fresh system of the same seed: {alike} of {count}")
    return alike != count


async def _known(count: int, seed: int) -> bool:
    differences: list[float] = []
    number = seed * 1_000_000
    while len(differences) < count:
        difference = await largest_difference(number, cache_dir())
        number += 1
        if difference is not None:
            differences.append(difference)
    equal = sum(difference <= EXACT for difference in differences)
    most = f"at most {max(differences):.1e}"
    print(f"kept and conditioned beliefs equal to enumeration within {EXACT:g}: {equal} of {count}, {most}")
    return equal != count
