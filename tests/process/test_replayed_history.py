from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest
from models import engine_of
from places import BUNDLES
from scripted_missions import Surroundings, breaking

from aos_deploy.history_check.replayed import Replay, replayed
from aos_protocol.messages import DecisionRecord, Message, MissionBegun, ModelAdopted
from aos_protocol.mission_rows import BEGUN
from aos_registry.catalogue import Catalogue
from aos_runtime.disk.journal import Journal
from aos_solver.building.build import BuiltModel
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms
from aos_solver.settings import Settings

STEPS = 5

Rows = list[tuple[str, Message]]

replace = msgspec.structs.replace


robot = breaking(jams=2, is_late=3)


async def played(tiger: BuiltModel) -> Rows:
    around = Surroundings(robot)
    async with engine_of(tiger, seed=3) as engine:
        model = RunningModel(1, engine)
        around.journal(BEGUN, MissionBegun("run", 1, 3, 1, model.digest))
        terms = Terms(
            name="run",
            limits=MissionLimits(step_limit=STEPS, goal_probability=2.0),
            search=Search(simulations=500, seed=3),
        )
        await Mission(terms, model, around).run()
    return around.journalled


async def replay_of(rows: Rows, run: Path) -> Replay:
    write_run(rows, run)
    return await replayed(run, lambda _: None)


def write_run(rows: Rows, run: Path):
    (run / "settings").mkdir(parents=True)
    settings = Settings(
        robot="t", service="solver", endpoint="", run_dir=str(run), project="tiger", cache_dir="", seed=3
    )
    (run / "settings" / "solver.json").write_bytes(msgspec.json.encode(settings))
    catalogue = Catalogue.open(run / "catalogue.db")
    files = {path.name: path.read_bytes() for path in (BUNDLES / "bench" / "tiger").iterdir()}
    catalogue.store("tiger", "digest", files, (), 0)
    catalogue.close()
    with Journal.open(run / "journal.db", survives_power_loss=False) as journal:
        for kind, payload in rows:
            journal.append(kind, payload)


def records(rows: Rows) -> list[tuple[int, DecisionRecord]]:
    return [(number, said) for number, (_, said) in enumerate(rows) if isinstance(said, DecisionRecord)]


def with_another_response(record: DecisionRecord) -> DecisionRecord:
    assert record.outcome is not None
    return replace(record, outcome=replace(record.outcome, response="tiger_right"))


def with_another_belief(record: DecisionRecord) -> DecisionRecord:
    return replace(record, belief=replace(record.belief, digest="0123456789abcdef"))


async def test_a_replay_gives_each_belief_again(tiger: BuiltModel, tmp_path):
    replay = await replay_of(await played(tiger), tmp_path)
    assert (replay.violations, replay.compared, replay.remark) == ([], 2 * STEPS, "")


@pytest.mark.parametrize("spoil", [with_another_response, with_another_belief])
async def test_a_history_with_another_belief_is_caught_at_its_row(
    spoil: Callable[[DecisionRecord], DecisionRecord], tiger: BuiltModel, tmp_path
):
    rows = await played(tiger)
    number, record = next(
        each
        for each in records(rows)
        if each[1].outcome is not None and each[1].outcome.response == "tiger_left"
    )
    rows[number] = (rows[number][0], spoil(record))
    replay = await replay_of(rows, tmp_path)
    assert {violation.rule for violation in replay.violations} == {"replay"}
    assert replay.violations[0].row == number + 1
    assert f"step {record.step} is observed as the belief" in replay.violations[0].text


async def test_a_run_of_another_seed_or_start_is_caught(tiger: BuiltModel, tmp_path):
    rows = await played(tiger)
    first = records(rows)[0][0]
    rows[first] = (rows[first][0], with_another_belief(records(rows)[0][1]))
    replay = await replay_of(rows, tmp_path)
    assert [violation.row for violation in replay.violations] == [first + 1]


async def test_what_cannot_be_replayed_is_said(tiger: BuiltModel, tmp_path):
    rows = await played(tiger)
    third = records(rows)[2][0]
    changed: Rows = [*rows[:third], ("adopted", ModelAdopted(2, "other", 1)), *rows[third:]]
    replay = await replay_of(changed, tmp_path / "changed")
    assert (replay.violations, replay.compared) == ([], 2)
    assert replay.remark == "the catalogue has no revision 2 of tiger"

    begun = rows[0][1]
    assert isinstance(begun, MissionBegun)
    other: Rows = [(BEGUN, replace(begun, model_digest="of an older AOS")), *rows[1:]]
    replay = await replay_of(other, tmp_path / "other")
    assert (replay.compared, replay.violations) == (0, [])
    assert "revision 1 gives another model here" in replay.remark

    write_run(rows, tmp_path / "bare")
    (tmp_path / "bare" / "catalogue.db").unlink()
    replay = await replayed(tmp_path / "bare", lambda _: None)
    assert "no catalogue of its documents" in replay.remark
