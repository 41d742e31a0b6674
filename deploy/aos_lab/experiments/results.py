"""The results of an experiment: figures with intervals and verdicts of each part, and what it was run
with; of missions in a simulated world also how fast they were, and pictures."""

import json
import os
import platform
import subprocess
from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import msgspec

from aos_lab.experiments.optimum import Regret
from aos_lab.trials.campaign import Played
from aos_lab.trials.claims import Verdict, asking_the_world, judge, matches
from aos_lab.trials.files import Experiment, Part
from aos_lab.trials.intervals import Interval, interval_of_mean, interval_of_share
from aos_lab.trials.trial import Trial
from aos_protocol import __version__
from aos_runtime.distribution import version_of

_PACKAGES = ("eclipse-zenoh", "pybullet", "numpy")


class Figures(msgspec.Struct, frozen=True, kw_only=True):
    """The figures of one part's missions. `value` is the discounted return, which only a model can count.

    `counts` are the means of the experiment's counted steps. `world_goal` is the share of missions that have
    reached the goal in the simulated world, whatever the belief. `speed` is how many seconds are simulated in
    one of the processor.
    """

    missions: int
    broken: int
    goal: Interval
    steps: Interval | None
    value: Interval | None
    counts: dict[str, Interval | None]
    endings: dict[str, int]
    first_actions: dict[str, int]
    world_goal: Interval | None = None
    speed: float | None = None


class PartResult(msgspec.Struct, frozen=True, kw_only=True):
    """One part as one of the two played it; `by` is `model` or `system`.

    `no_optimum` says why the optimum that was asked for cannot be worked out.
    """

    name: str
    by: str
    deploy: str
    bundles: tuple[str, ...]
    digest: str
    seeds: tuple[int, ...]
    figures: Figures
    verdicts: tuple[Verdict, ...]
    broken: dict[str, str]
    regret: Regret | None = None
    no_optimum: str = ""
    picture: str = ""


class Surroundings(msgspec.Struct, frozen=True, kw_only=True):
    """The place and time of a run."""

    date: str
    machine: str
    versions: dict[str, str]
    commit: str = ""

    def text(self, command: str) -> str:
        """The line under a report's title."""
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        commit = f", commit {self.commit}" if self.commit else ""
        return f"`{command}`, {self.date}, {self.machine}; {versions}{commit}."


class Results(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that a report shows."""

    name: str
    title: str
    about: str
    command: str
    surroundings: Surroundings
    parts: tuple[PartResult, ...]


def result_of(name: str, part: Part, by: str, played: Played, experiment: Experiment) -> PartResult:
    """A part's figures and verdicts."""
    truth = part.truth or experiment.truth
    claims = [asking_the_world(claim, by, truth) for claim in part.claims if claim.only in (None, by)]
    return PartResult(
        name=name,
        by=by,
        deploy=part.deploy,
        bundles=part.bundles,
        digest=played.digest,
        seeds=tuple(trial.seed for trial in played.trials),
        figures=figures_of(played.trials, experiment.counts, truth if by == "system" else ""),
        verdicts=tuple(judge(claim, played.trials, by) for claim in claims),
        broken={str(trial.seed): trial.fault for trial in played.trials if trial.fault},
    )


def figures_of(trials: Sequence[Trial], counts: dict[str, str], truth: str = "") -> Figures:
    """Missions that broke count as ones that did not reach the goal, and in nothing else."""
    whole = [trial for trial in trials if not trial.fault]
    values = [trial.value for trial in whole if trial.value is not None]
    return Figures(
        missions=len(trials),
        broken=len(trials) - len(whole),
        goal=interval_of_share(sum(trial.goal for trial in whole), len(trials)),
        steps=interval_of_mean([len(trial.actions) for trial in whole]),
        value=interval_of_mean(values),
        counts={
            name: interval_of_mean([sum(matches(pattern, step) for step in trial.steps) for trial in whole])
            for name, pattern in counts.items()
        },
        endings=dict(Counter(trial.ending for trial in trials).most_common()),
        first_actions=dict(Counter(trial.actions[0] for trial in whole if trial.actions).most_common()),
        world_goal=interval_of_share(sum(_holds(truth, trial) for trial in whole), len(trials))
        if truth
        else None,
        speed=simulated_speed(whole),
    )


def _holds(truth: str, trial: Trial) -> bool:
    return bool(trial.states) and truth in trial.states[-1]


def surroundings() -> Surroundings:
    """This machine, today."""
    installed = {package: version for package in _PACKAGES if (version := version_of(package))}
    return Surroundings(
        date=datetime.now(UTC).date().isoformat(),
        machine=f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}",
        versions={"aos": __version__, "python": platform.python_version(), **installed},
        commit=commit_of(Path(__file__).parent),
    )


def commit_of(folder: Path) -> str:
    """The commit of the checkout that a folder is in, with a + where files differ from it; empty without a
    checkout."""
    try:
        asked = subprocess.run(
            ["git", "describe", "--always", "--abbrev=12", "--exclude=*", "--dirty=+"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=10,
            check=False,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return asked.stdout.strip() if asked.returncode == 0 else ""


def simulated_speed(trials: Sequence[Trial]) -> float | None:
    """Simulated seconds for each second of processor time, pictures included; None where nobody counted."""
    simulated = used = 0.0
    for trial in trials:
        lines = list(_lines(trial))
        if lines and all("processor_s" in line for line in lines):
            simulated += lines[-1]["time_s"]
            used += sum(line["processor_s"] for line in lines)
    return simulated / used if used else None


def keep_picture(runs: Path, seeds: Sequence[int], target: Path) -> Path | None:
    """The first mission with pictures as it looked at its end, without loss; None where there are none."""
    for seed in seeds:
        pictures = sorted(runs.glob(f"seed-{seed}/*/pictures/*.png"))
        if pictures:
            from PIL import Image  # Whoever has pictures has it.

            target.parent.mkdir(parents=True, exist_ok=True)
            with Image.open(pictures[-1]) as picture:
                picture.save(target, lossless=True)
            return target
    return None


def _lines(trial: Trial) -> Iterator[dict[str, Any]]:
    """The lines of a world's record, of which the model's states are none."""
    for state in trial.states:
        if state.startswith("{"):
            yield json.loads(state)
