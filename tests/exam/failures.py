"""The exam of broken skills: what robots claim that the world denies, and whether others stand in."""

import argparse
import dataclasses
from collections import defaultdict
from pathlib import Path

import msgspec

from aos_protocol.errors import AosError

from .broken import LIMITS, Played, played_job
from .jobs import job

STANDS_IN_TARGET = 0.95
"""The robot has to do this share of the jobs that it can do without its broken skill."""


@dataclasses.dataclass
class Failures:
    """The missions that were played, by fault."""

    played: list[Played] = dataclasses.field(default_factory=list)

    @property
    def claims(self) -> list[Played]:
        return [trial for trial in self.played if trial.is_claimed]

    @property
    def false_claims(self) -> list[Played]:
        return [trial for trial in self.played if trial.is_false_claim]

    @property
    def spared(self) -> list[Played]:
        """Those that the robot does without its broken skill."""
        return [trial for trial in self.played if trial.is_spare_at_goal]

    @property
    def stood_in(self) -> list[Played]:
        """Those that it does, too, with that skill broken."""
        return [trial for trial in self.spared if trial.is_at_goal]

    def is_passed(self) -> bool:
        allowed = 1 - LIMITS.goal_probability
        return (
            bool(self.claims)
            and bool(self.spared)
            and len(self.false_claims) <= allowed * len(self.claims)
            and len(self.stood_in) >= STANDS_IN_TARGET * len(self.spared)
        )

    def table(self) -> str:
        by_fault: dict[str, list[Played]] = defaultdict(list)
        for trial in self.played:
            by_fault[trial.fault].append(trial)
        rows = [(fault, Failures(played)) for fault, played in sorted(by_fault.items())]
        return "\n".join(
            [
                f"{'fault':16} {'missions':>8} {'claims':>7} {'false':>6} {'others do':>10} {'done':>5}",
                *(
                    f"{fault:16} {len(some.played):8} {len(some.claims):7} {len(some.false_claims):6} "
                    f"{len(some.spared):10} {len(some.stood_in):5}"
                    for fault, some in [*rows, ("all", self)]
                ),
            ]
        )


async def examine_failures(arguments: argparse.Namespace, cache_dir: Path) -> int:
    """Plays the jobs; each false claim and each job that was not done is printed."""
    found = Failures()
    faults = 0
    for seed in range(arguments.seed, arguments.seed + arguments.models):
        try:
            played = await played_job(job(seed), cache_dir, arguments.simulations)
        except AosError as error:
            faults += 1
            print(f"jobs/{seed}: {error}", flush=True)
            continue
        found.played.append(played)
        if arguments.json:
            print(msgspec.json.encode(played).decode(), flush=True)
        elif played.is_false_claim or (played.is_spare_at_goal and not played.is_at_goal):
            what = "claims a goal" if played.is_false_claim else f"ends with {played.ending}"
            text = f"{what}, and is not there" if played.is_false_claim else f"{what}, where others do it"
            print(f"{played.name}: {played.broken} {played.fault}: {text}", flush=True)
    print(found.table())
    return 0 if found.is_passed() and not faults else 1
