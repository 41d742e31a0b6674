"""Recorded missions: what was done, what came back, and the world's truth where somebody has recorded it."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.export.run_bundle import SUFFIX, opened_bundle
from aos_deploy.printing import from_here
from aos_deploy.runs.end import beginning_of
from aos_lab.trials.trial import kept_trials, truth_lines
from aos_protocol.errors import DeployError
from aos_protocol.messages import DecisionRecord
from aos_protocol.mission_rows import DECISION
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import JOURNAL


class RecordedStep(msgspec.Struct, frozen=True):
    """`truth` holds the values after the step, as text, of the state variables that are known."""

    action: str
    response: str
    truth: tuple[tuple[str, str], ...] = ()
    numbers: dict[str, Any] = {}


class RecordedMission(msgspec.Struct, frozen=True):
    """`ends_early` says why later steps cannot be used. `seed` is 0 where nobody knows it.

    `mission_parameters` are the values that it had.
    """

    name: str
    steps: tuple[RecordedStep, ...]
    ends_early: str = ""
    seed: int = 0
    mission_parameters: dict[str, str] = {}


def read_missions(path: Path) -> tuple[RecordedMission, ...]:
    """Those of a run directory, of a file of runs, of one that an experiment keeps, or of all in a folder.

    DeployError AOS801 where there are none. A folder with both has its missions in its file. A run that
    a folder has twice, as a directory and in a file of runs, counts once.
    """
    missions = tuple(_missions(path, path))
    if not missions:
        hint = "Name a run, a folder of runs, a file of `aos export`, or a folder of `aos experiment run`"
        raise DeployError(f"{path} holds no recorded missions", hint=hint)
    return missions


def _missions(path: Path, named: Path) -> Iterator[RecordedMission]:
    if path.suffix == SUFFIX and path.is_file():
        for run in opened_bundle(path):
            yield from _missions(run, named / run.name)
    elif path.name == "missions.jsonl":
        yield from _of_file(path)
    elif (path / "missions.jsonl").is_file():
        yield from _of_file(path / "missions.jsonl")
    elif (path / JOURNAL).is_file():
        yield _of_run(path, str(from_here(named)))
    elif path.is_dir():
        folders = sorted(each for each in path.iterdir() if each.is_dir() and not each.is_symlink())
        for below in folders:
            yield from _missions(below, named / below.name)
        names = {below.name for below in folders}
        for file in sorted(path.glob(f"*{SUFFIX}")):
            for run in opened_bundle(file):
                if run.name not in names:
                    names.add(run.name)
                    yield from _missions(run, named / file.name / run.name)


def _of_file(path: Path) -> Iterator[RecordedMission]:
    """The newest record of each seed."""
    trials = {kept.trial.seed: kept.trial for kept in kept_trials(path)}
    for seed, trial in sorted(trials.items()):
        recorded: list[tuple[str, str, dict[str, Any]]] = [
            (action, response, {}) for action, response in zip(trial.actions, trial.responses, strict=True)
        ]
        yield replace(
            _mission(f"{from_here(path.parent)}, seed {seed}", recorded, trial.states),
            seed=seed,
            mission_parameters=trial.mission_parameters,
        )


def _of_run(run: Path, name: str) -> RecordedMission:
    begun = beginning_of(run)
    start = begun.start if begun is not None else None
    if start is not None and (start.belief != "initial" or start.given or start.idle):
        return RecordedMission(name, (), "the mission did not begin with the initial belief")
    with Journal.read(run / JOURNAL) as journal:
        rows = [row.read_as(DecisionRecord) for row in journal.walk(DECISION)]
    recorded: list[tuple[str, str, dict[str, Any]]] = []
    for record in rows:
        if record.outcome is not None:
            is_seen = record.outcome.status == "observed"
            recorded.append(
                (record.action, record.outcome.response if is_seen else "", record.outcome.numbers)
            )
    mission = _mission(name, recorded, truth_lines(run))
    if begun is None:
        return mission
    return replace(mission, mission_parameters=begun.mission_parameters)


def _mission(
    name: str, recorded: Iterable[tuple[str, str, dict[str, Any]]], lines: Iterable[str]
) -> RecordedMission:
    truths = dict(_truths(lines))
    steps: list[RecordedStep] = []
    for number, (action, response, numbers) in enumerate(recorded, 1):
        if not response:
            return RecordedMission(name, tuple(steps), f"step {number} brought no observation")
        steps.append(RecordedStep(action, response, truths.get(number, ()), numbers))
    return RecordedMission(name, tuple(steps))


def _truths(lines: Iterable[str]) -> Iterator[tuple[int, tuple[tuple[str, str], ...]]]:
    """Each line by the number of its step: of a world, of a played model, or a state's text alone."""
    for number, line in enumerate(lines, 1):
        step, state = number, line
        if line.startswith("{"):
            record = json.loads(line)
            step, state = record.get("step", number), record.get("state", {})
        if isinstance(state, dict):
            yield step, tuple((name, _text(value)) for name, value in state.items())
        else:
            pairs = (pair.partition("=") for pair in state.strip().split(", "))
            yield step, tuple((name, value) for name, mark, value in pairs if mark)


def _text(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
