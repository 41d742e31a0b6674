"""An experiment's missions: those of its parts, and those of scripts."""

import asyncio
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_lab.calibration.calibrate import calibrate
from aos_lab.calibration.records import RecordedMission, read_missions
from aos_lab.experiments.optimum import Optimum, optimum_of, regret_of
from aos_lab.experiments.results import PartResult, keep_picture, result_of, surroundings
from aos_lab.experiments.statistics import ScriptedStep, Statistics, steps_of
from aos_lab.trials.campaign import Place, play_campaign
from aos_lab.trials.files import Experiment, Part, ScriptFile
from aos_lab.trials.setting import Player, Setting, deployment_of
from aos_protocol.errors import IntractableError

Begin = Callable[[str, int], Callable[[], None]]
"""Begins so many missions of this text, and gives what is to be called after each."""


class ExperimentRun(msgspec.Struct, frozen=True):
    """The missions of an experiment's file with seeds from `first_seed`, and the folder of their records."""

    path: Path
    experiment: Experiment
    folder: Path
    first_seed: int
    place: Place

    def results(
        self, names: Sequence[str], missions: Mapping[Player, int], begin: Begin
    ) -> Iterator[PartResult]:
        """The results of these parts, of so many missions by each player."""
        for by, number in missions.items():
            for name in names if number else ():
                yield self._result(name, by, number, begin(f"{name}, {by}", number))

    def _result(self, name: str, by: Player, number: int, on_trial: Callable[[], None]) -> PartResult:
        part: Part = self.experiment.parts[name]
        # Faults are the simulated world's; the model's world has none.
        setting = replace(part, by=by, faults={} if by == "model" else part.faults)
        seeds = range(self.first_seed, self.first_seed + number)
        out = self.folder / by / name
        played = asyncio.run(
            play_campaign(
                setting, seeds, folder=self.path.parent, out=out, place=self.place, on_trial=on_trial
            )
        )
        result = result_of(name, part, by, played, self.experiment)
        if by == "model" and self.experiment.optimum:
            try:
                optimum = _known_optimum(out, played.digest, setting, self.path.parent)
            except IntractableError as error:
                return replace(result, no_optimum=error.message)
            return replace(result, regret=regret_of(optimum, played.trials))
        target = self.folder / "pictures" / f"{name}.webp"
        if by == "system" and keep_picture(out / "runs", result.seeds, target):
            return replace(result, picture=str(target.relative_to(self.folder)))
        return result


def _known_optimum(out: Path, digest: str, setting: Setting, folder: Path) -> Optimum:
    """Reads the optimum that was worked out for the same documents and settings, or works it out now."""
    kept = out / f"best-{digest}.json"
    if kept.is_file():
        return msgspec.json.decode(kept.read_bytes(), type=Optimum)
    optimum = asyncio.run(optimum_of(deployment_of(setting, folder, out)))
    kept.write_bytes(msgspec.json.encode(optimum))
    return optimum


class _ScriptRun(msgspec.Struct):
    """The outcome of a script: its seeds, the number of missions that broke, and the others."""

    seeds: str
    broken: int
    missions: list[RecordedMission]


def statistics_of(
    path: Path, file: ScriptFile, command: str, *, folder: Path, repeat: int, first_seed: int, begin: Begin
) -> Statistics:
    """The statistics of a file of scripts, each played so many times in a simulated world.

    The `command` makes the same statistics again.
    """
    runs: dict[str, _ScriptRun] = {}
    for name, part in file.parts.items():
        number = part.missions * repeat
        setting = replace(part, by="system")
        # No two scripts have the same seeds.
        seeds = range(first_seed, first_seed + number)
        first_seed += number
        on_trial = begin(name, number)
        played = asyncio.run(
            play_campaign(setting, seeds, folder=path.parent, out=folder / name, on_trial=on_trial)
        )
        whole = {trial.seed for trial in played.trials if not trial.fault}
        recorded = [mission for mission in read_missions(folder / name) if mission.seed in whole]
        runs[name] = _ScriptRun(f"{seeds[0]} to {seeds[-1]}", number - len(whole), recorded)
    missions = [mission for run in runs.values() for mission in run.missions]
    steps: list[ScriptedStep] = [step for name, run in runs.items() for step in steps_of(name, run.missions)]
    calibrations = {
        name: calibrate(missions, [(path.parent / bundle).resolve() for bundle in bundles])
        for name, bundles in file.calibrates.items()
    }
    return Statistics(
        name=path.stem,
        title=file.title,
        about=file.about,
        command=command,
        surroundings=surroundings(),
        seeds={name: run.seeds for name, run in runs.items()},
        broken={name: run.broken for name, run in runs.items()},
        steps=tuple(steps),
        calibrations=calibrations,
    )
