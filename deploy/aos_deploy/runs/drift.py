"""The sequential tests of skills over the missions of several runs, one fold for each model."""

from collections.abc import Iterable
from pathlib import Path

import msgspec

from aos_deploy.export.kept_missions import KeptMission, kept_missions
from aos_protocol.messages import DecisionRecord, DriftTest, DriftTests
from aos_protocol.mission_rows import DECISION, DRIFT
from aos_solver.mission.rules.drift import after_use


class ModelTests(msgspec.Struct):
    """The tests of one model after all missions that it had. `revision` is the newest of its documents.

    `begun_at` names the mission and the step at which each alarm began, by skill and response.
    """

    tests: DriftTests
    revision: int = 0
    missions: int = 0
    begun_at: dict[tuple[str, str], str] = {}


def drift_of_runs(runs: Iterable[Path]) -> list[ModelTests]:
    """The tests of each model, of the newest one last. They begin with the first of the missions.

    Missions are taken in the order of the runs. A record whose model has no tests in its journal, as those of
    versions before there were tests, counts for none. StorageError AOS702 at a row that is damaged.
    """
    models: dict[str, ModelTests] = {}
    for run in runs:
        for mission in kept_missions(run):
            _fold(models, mission)
    return list(models.values())


def _fold(models: dict[str, ModelTests], mission: KeptMission) -> None:
    decision: DecisionRecord | None = None
    known: set[str] = set()
    for row in mission.rows():
        if row.kind == DRIFT:
            _begin(models, row.read_as(DriftTests))
        if row.kind != DECISION:
            continue
        record = row.read_as(DecisionRecord)
        if record.outcome is None:
            decision = record
        model = models.get(record.model_digest)
        if model is None or decision is None:
            continue
        if record.model_digest not in known:
            known.add(record.model_digest)
            model.missions += 1
            # The newest model is the last one.
            models[record.model_digest] = models.pop(record.model_digest)
        model.revision = record.revision
        if record.outcome is not None:
            _take(model, decision, record, mission.name)


def _begin(models: dict[str, ModelTests], said: DriftTests) -> None:
    """Begins with the tests of a row, and without what they have behind them."""
    blank = tuple(DriftTest(test.skill, test.response) for test in said.tests)
    tests = DriftTests(said.model_digest, said.count, blank)
    models.setdefault(said.model_digest, ModelTests(tests))


def _take(model: ModelTests, decision: DecisionRecord, record: DecisionRecord, mission: str) -> None:
    model.tests = after_use(model.tests, decision, record)
    for test in model.tests.tests:
        if test.is_alarm:
            model.begun_at.setdefault((test.skill, test.response), f"{mission}, step {record.step}")
