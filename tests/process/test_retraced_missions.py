from pathlib import Path

import msgspec
import pytest
from hall import HALL, changed, with_bell
from models import built_text, engine_of_text
from projects import text_project
from scripted_missions import Surroundings, observed
from texts import encoded

from aos_deploy.history_check.replayed import replayed
from aos_deploy.places import cache_dir
from aos_protocol.documents import Project
from aos_protocol.errors import StorageError
from aos_protocol.messages import Activate, DecisionRecord, Message, MissionBegun, ModelAdopted, Outcome
from aos_protocol.mission_rows import BEGUN
from aos_registry.catalogue import Catalogue
from aos_runtime.clock import SystemClock
from aos_runtime.disk.journal import Journal, JournalRow
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.earlier_models import earlier_models
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import RunningModel, Successor, Takeover
from aos_solver.mission.records.memory import MissionMemory, folded
from aos_solver.mission.records.stretches import Stretch, after, models_before
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms
from aos_solver.settings import Settings

STEPS = 5
BEARS = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
REVISIONS = {
    1: HALL,
    2: changed(look=("0.9 : 0.2", "0.6 : 0.3")),  # The same state: the belief is imported.
    3: BEARS | {"look.sd": BEARS["look.sd"].replace("0.9 : 0.2", "0.0 : 0.0")},  # Its past is impossible.
}
SINCE = {2: 2, 3: 3}
"""The number of steps after which a revision takes over."""

Rows = list[tuple[str, Message]]


def robot(request: Activate) -> Outcome:
    return observed(request, "above" if request.id.step == 1 else "below")


class Growing(Surroundings):
    def __init__(self, successors: dict[int, Successor]):
        super().__init__(robot)
        self._successors = successors

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        successor = self._successors.get(running.revision + 1)
        if successor is None or len(past) < SINCE[running.revision + 1]:
            return None
        return await successor.take_over(running, past)


def settings(run: Path) -> Settings:
    return Settings(
        robot="t", service="solver", endpoint="", run_dir=str(run), project="hall", cache_dir=str(cache_dir())
    )


def terms(epoch: int) -> Terms:
    limits = MissionLimits(step_limit=STEPS, goal_probability=2.0)
    return Terms(name="run", epoch=epoch, limits=limits, search=Search(simulations=100, seed=1))


async def whole() -> Rows:
    engines = {
        number: await Engine.start(await built_text(files), seed=1) for number, files in REVISIONS.items()
    }
    try:
        models = {number: RunningModel(number, engine) for number, engine in engines.items()}
        around = Growing({number: Successor(models[number], SystemClock()) for number in SINCE})
        around.journal(BEGUN, MissionBegun("run", 1, 1, 1, models[1].digest))
        await Mission(terms(1), models[1], around).run()
    finally:
        for engine in engines.values():
            await engine.close()
    return around.journalled


async def documents(revision: int) -> Project:
    return text_project(REVISIONS[revision])


def memory_of(rows: Rows) -> MissionMemory:
    return folded(
        JournalRow(number, number, kind, msgspec.json.encode(payload))
        for number, (kind, payload) in enumerate(rows, start=1)
    )


async def taken_up(rows: Rows, revision: int, run: Path) -> Rows:
    memory = memory_of(rows)
    around = Surroundings(robot)
    async with engine_of_text(REVISIONS[revision]) as engine:
        running = RunningModel(revision, engine)
        of_before = settings(run)
        earlier = await earlier_models(memory, running, documents, of_before, lambda text: None)
        begun = MissionBegun("run", 2, 1, revision, running.digest, is_retraced=bool(earlier))
        around.journal(BEGUN, begun)
        await Mission(terms(2), running, around, memory, earlier=earlier).run()
        assert all(before.model.engine.pid is None for before in earlier)
    return [*rows, *around.journalled]


def digests(rows: Rows) -> list[str]:
    records = [said for _, said in rows if isinstance(said, DecisionRecord)]
    assert all(record.belief.digest for record in records)
    return [record.belief.digest for record in records]


def write_run(rows: Rows, run: Path):
    (run / "settings").mkdir(parents=True)
    (run / "settings" / "solver.json").write_bytes(msgspec.json.encode(settings(run)))
    catalogue = Catalogue.open(run / "catalogue.db")
    for number, files in REVISIONS.items():
        catalogue.store("hall", f"digest {number}", encoded(files), (), 0)
    catalogue.close()
    with Journal.open(run / "journal.db", survives_power_loss=False) as journal:
        for kind, payload in rows:
            journal.append(kind, payload)


async def test_a_belief_that_came_through_three_models_is_that_of_the_undisturbed_twin(tmp_path):
    rows = await whole()
    adopted = [said for _, said in rows if isinstance(said, ModelAdopted)]
    assert [row.by for row in adopted] == ["import", "projection"]
    last = rows.index(("adopted", adopted[-1]))
    # Right after the takeover, in the middle of a step, and at the end of one.
    for cut in (last + 1, *(n for n, (kind, _) in enumerate(rows) if n > last and kind == "outcome")):
        journal = await taken_up(rows[:cut], 3, tmp_path)
        assert digests(journal) == digests(rows), f"cut off after row {cut}, {rows[cut - 1][0]}"
    # `aos check` goes through the same models.
    write_run(journal, tmp_path / "run")
    replay = await replayed(tmp_path / "run", lambda text: None)
    assert (replay.violations, replay.compared, replay.remark) == ([], 2 * STEPS, "")


async def test_documents_that_nobody_has_used_yet_import_the_belief_of_the_last_ones(tmp_path):
    rows = await whole()
    first = next(number for number, (_, said) in enumerate(rows) if isinstance(said, ModelAdopted))
    journal = await taken_up(rows[:first], 2, tmp_path)
    assert digests(journal)[:5] == digests(rows)[:5], "they take over at once, as after the same step before"
    assert memory_of(journal).stretches[-1].by == "import"


async def test_a_revision_that_is_gone_leaves_the_replay_to_the_newest(tmp_path):
    async def gone(_: int) -> Project:
        raise StorageError("the catalogue has no revision 1", code="AOS702")

    rows = await whole()
    async with engine_of_text(REVISIONS[3]) as engine:
        running, of_before = RunningModel(3, engine), settings(tmp_path)
        assert await earlier_models(memory_of(rows), running, gone, of_before, lambda text: None) == ()


def test_a_replay_needs_no_model_before_it():
    stretches: tuple[Stretch, ...] = ()
    rows = [
        (MissionBegun("m", 1, 1, 1, "a"), 0),
        (ModelAdopted(2, "b", 1, "import"), 1),
        (ModelAdopted(3, "c", 2, "replay"), 2),
        (ModelAdopted(4, "d", 3, "import"), 4),
    ]
    for said, steps in rows:
        stretches = after(stretches, said, steps)
    assert models_before(stretches, "d", 6) == ((stretches[2], 4),)
    assert models_before(stretches[:3], "c", 6) == ()
    assert models_before(stretches, "e", 6) == ((stretches[2], 4), (stretches[3], 6))
    retraced = after(stretches, MissionBegun("m", 2, 1, 4, "d", is_retraced=True), 6)
    assert retraced == stretches
    replayed_alone = after(stretches, MissionBegun("m", 2, 1, 4, "d"), 6)
    assert models_before(replayed_alone, "d", 7) == ()


@pytest.mark.parametrize("digest", ["a", "b"])
def test_a_mission_without_a_model_before_has_nothing_to_retrace(digest):
    assert models_before((), digest, 0) == ()
