"""The rule `replay`: the outcomes of a run's journal once more, through an engine of the run's documents."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from aos_deploy.history_check.check import JOURNAL
from aos_deploy.history_check.rules import Violation
from aos_deploy.program import cache_dir
from aos_language.load import load_files
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, StorageError
from aos_protocol.messages import BeliefSummary, DecisionRecord, MissionBegun, ModelAdopted
from aos_registry.catalogue import Catalogue
from aos_runtime.journal import Journal
from aos_runtime.mission_folders import mission_folders
from aos_solver.building.project_build import build_project, emitted_model
from aos_solver.child.engine import Engine
from aos_solver.mission.endings import MissionLimits
from aos_solver.mission.failures import FailureRules, Failures
from aos_solver.mission.memory import BEGUN
from aos_solver.mission.past import evidence_of, updated
from aos_solver.settings import Settings

__all__ = ["Replay", "replayed"]


class Replay(msgspec.Struct):
    """The violations of the rule, how many records were compared, and why others were not."""

    violations: list[Violation] = []
    compared: int = 0
    remark: str = ""


class _Record(NamedTuple):
    row: int
    record: DecisionRecord


async def replayed(run: Path, on_progress: Callable[[str], None]) -> Replay:
    """Replays the journals of a run that is over, each up to the first change of its model.

    A run that cannot be replayed, or not to its end, has the reason as the remark.
    """
    replay = Replay()
    remarks: Counter[str] = Counter()
    folders = [str((folder / JOURNAL).relative_to(run)) for folder in mission_folders(run).values()]
    for file in folders or [JOURNAL]:
        replay.remark = ""
        try:
            await _replay(run, file, replay, on_progress)
        except (AosError, OSError, msgspec.MsgspecError) as error:
            replay.remark = str(error)
        remarks[replay.remark] += 1
    if folders:
        texts = (f"{number} of {len(folders)} missions: {text}" for text, number in remarks.items() if text)
        replay.remark = "; ".join(texts)
    return replay


async def _replay(run: Path, file: str, replay: Replay, on_progress: Callable[[str], None]) -> None:
    settings = msgspec.json.decode((run / "settings" / "solver.json").read_bytes(), type=Settings)
    begun: MissionBegun | None = None
    records: list[_Record] = []
    for row, said in _rows(run / file):
        if isinstance(said, DecisionRecord):
            records.append(_Record(row, said))
        elif begun is None:
            begun = said if isinstance(said, MissionBegun) else None
        elif said.model_digest != begun.model_digest:
            replay.remark = f"row {row} changes the model: what follows is not replayed"
            break
    if begun is None or not any(record.belief.digest for _, record in records):
        replay.remark = replay.remark or "no belief of the journal has a digest"
        return
    start = begun.start
    if start is not None and (start.belief != "initial" or start.idle or start.given):
        replay.remark = "it begins with another belief than the initial one"
        return
    project = _project(run, settings, begun.revision)
    if emitted_model(msgspec.structs.replace(project, mission_values=())).digest != begun.model_digest:
        replay.remark = f"revision {begun.revision} gives another model here: another version of AOS ran it"
        return
    built = await build_project(project, cache_dir(), on_progress)
    engine = await Engine.start(
        built, seed=begun.seed, impossible_observation=settings.impossible_observation
    )
    try:
        await engine.start_with(begun.mission_parameters)
        await _compare(engine, settings, records, replay, file)
    finally:
        await engine.close()


async def _compare(
    engine: Engine, settings: Settings, records: list[_Record], replay: Replay, file: str
) -> None:
    failures = Failures(msgspec.convert(settings, FailureRules, from_attributes=True))
    limits = msgspec.convert(settings, MissionLimits, from_attributes=True)
    belief = await engine.summary()
    for row, record in records:
        if record.outcome is not None:
            evidence = evidence_of(record, record.outcome, failures)
            belief = (await updated(engine, evidence, limits.refuted_below, number=record.step)).summary
        if record.belief.digest and belief.digest:
            replay.compared += 1
            if record.belief.digest != belief.digest:
                replay.violations.append(Violation("replay", file, row, _text(record, belief)))


def _text(record: DecisionRecord, belief: BeliefSummary) -> str:
    when = "decided with" if record.outcome is None else "observed as"
    return f"step {record.step} is {when} the belief {record.belief.digest}; its replay gives {belief.digest}"


_KINDS: dict[str, type[Any]] = {BEGUN: MissionBegun, "adopted": ModelAdopted, "decision": DecisionRecord}


def _rows(path: Path) -> Iterator[tuple[int, Any]]:
    with Journal.read(path) as journal:
        for row in journal.walk():
            if row.kind in _KINDS:
                yield row.seq, msgspec.json.decode(row.payload, type=_KINDS[row.kind])


def _project(run: Path, settings: Settings, number: int) -> Project:
    """The documents of a revision, with the mission's constraints; StorageError AOS702 if they are gone."""
    path = run / "catalogue.db"
    if not path.exists():
        raise StorageError("the run has no catalogue of its documents", code="AOS702")
    catalogue = Catalogue.open(path)
    try:
        revision = catalogue.revision(settings.project, number)
    finally:
        catalogue.close()
    project = None if revision is None else load_files(revision.files, name=settings.project).project
    if project is None:
        raise StorageError(f"the catalogue has no revision {number} of {settings.project}", code="AOS702")
    return msgspec.structs.replace(
        project, constraints=settings.constraints, mission_values=settings.mission_values
    )
