"""A run whose `aos-up` has died, made ready to go on: the same folder, settings and documents."""

from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from aos_deploy.deployment.reading import Deployment, read_deploy_file, without_a_robot
from aos_deploy.history_check.check import MIDDLEWARE
from aos_deploy.history_check.ledger_rules import ADAPTER_KINDS, MIDDLEWARE_KINDS
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import RunRecord
from aos_protocol.errors import DeployError, StorageError
from aos_protocol.messages import ActivationId
from aos_runtime.disk.journal import Journal, JournalRow
from aos_runtime.disk.mission_folders import JOURNAL, stays
from aos_solver.mission.records.logbook import entries_of
from aos_solver.mission.records.memory import MissionMemory, folded


class TakenUp(msgspec.Struct, frozen=True):
    """A run that goes on: its folder, which is locked now, and its record."""

    run: RunDirectory
    record: RunRecord
    has_begun: bool
    """True where the mission had begun, so that the documents are in the catalogue."""


def take_up(path: Path) -> tuple[Deployment, TakenUp]:
    """The deployment of a run as it was started, and the run.

    DeployError AOS801 if the path is no run, AOS810 if the run goes on or its mission has ended. StorageError
    AOS702 if its journal is damaged, or lacks what a ledger of the run was asked for.
    """
    run = RunDirectory(path.resolve())
    record = run.read_record()
    if not run.hold():
        hint = "Follow it with `aos decisions`, or end it with a signal to its aos-up"
        raise DeployError(f"{run.path.name} goes on", code="AOS810", hint=hint)
    has_begun, ending = _of_system(run) if stays(run.path) else _of_mission(run)
    if ending:
        hint = "Start a new run with aos-up and the deploy file"
        raise DeployError(f"{run.path.name} has ended: {ending}", code="AOS810", hint=hint)
    run.keeps_settings = True
    deployment = read_deploy_file(Path(record.deploy_file))
    if record.is_played:
        deployment = without_a_robot(deployment)
    file = deployment.file
    is_port = record.endpoint.startswith("tcp/")
    file = replace(
        file,
        stay=stays(run.path),
        solver=replace(file.solver, seed=record.seed),
        bus=replace(file.bus, listen=record.endpoint if is_port else ""),
    )
    deployment = replace(deployment, file=file, runs=run.path.parent)
    return deployment, TakenUp(run, record, has_begun)


def worlds_text(deployment: Deployment) -> str:
    """Tells which simulated worlds a run that goes on has lost; empty where it has none."""
    names = [plan.name for plan in deployment.adapters if plan.is_process and not plan.kind.is_restarted]
    if not names:
        return ""
    return f"the world of {' and '.join(names)} begins anew: what was done in it is gone, and believed still"


def _of_mission(run: RunDirectory) -> tuple[bool, str]:
    """Says whether the mission had begun, and how it has ended, if it has."""
    path = run.path / JOURNAL
    if not path.exists():
        return False, ""  # It died before the solver was there.
    with Journal.read(path) as journal:
        memory = folded(journal.rows())
    _check_that_all_was_intended(run.path, path, memory)
    ending = memory.state.ending if memory.has_ended and memory.state is not None else ""
    return memory.epoch > 0, ending


def _check_that_all_was_intended(run: Path, journal: Path, memory: MissionMemory) -> None:
    """Refuses a journal that has lost its last rows: what was asked for had been intended there before.

    A write-ahead log that was cut off looks as if its process had died before them.
    """
    steps = {step.decision.step for step in memory.steps}
    if memory.pending is not None and memory.pending.intention is not None:
        steps.add(memory.pending.intention.id.step)
    ledgers = [
        (run / MIDDLEWARE, MIDDLEWARE_KINDS),
        *((path, ADAPTER_KINDS) for path in run.glob("adapter-*.db")),
    ]
    for path, kinds in ledgers:
        if not path.exists():
            continue
        with Journal.read(path) as ledger:
            for row in ledger.walk("started"):
                id = _id_in(row, kinds["started"])
                if id.mission == run.name and id.step not in steps:
                    raise StorageError(
                        f"the journal {journal} has lost its last rows: it did not intend {id}, for which "
                        f"{path.name} was asked",
                        code="AOS702",
                        hint="Start a new run with aos-up and the deploy file",
                    )


def _id_in(row: JournalRow, kind: type[Any]) -> ActivationId:
    id: ActivationId = row.read_as(kind).id
    return id


def _of_system(run: RunDirectory) -> tuple[bool, str]:
    """Says the same of a system that stays. Between missions it goes on, until it was stopped."""
    summary = run.read_summary()
    return bool(entries_of(run.path)), summary.ending if summary is not None else ""
