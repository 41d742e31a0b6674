"""Counting how picks end, each in a fresh world."""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path


def pick_options(description: str | None) -> argparse.ArgumentParser:
    """The command line of a world's frequencies: the world file and the number of picks."""
    parser = argparse.ArgumentParser(prog="frequencies", description=description)
    parser.add_argument("world", type=Path)
    parser.add_argument("picks", type=int, nargs="?", default=60)
    return parser


def counted(outcome_of_pick: Callable[[int], str], seeds: Sequence[int], label: str = "") -> Counter[str]:
    """The outcomes of a pick with each seed; says on stderr how far it is."""
    counts: Counter[str] = Counter()
    for number, seed in enumerate(seeds, 1):
        counts[outcome_of_pick(seed)] += 1
        sys.stderr.write(f"\r{label}{number} of {len(seeds)} picks")
    sys.stderr.write("\n")
    return counts


def shares(counts: Counter[str], outcomes: Sequence[str]) -> str:
    """The share of each outcome, as a line for people."""
    return ", ".join(f"{outcome} {counts[outcome] / counts.total():.2f}" for outcome in outcomes)
