from pathlib import Path

import msgspec
import pytest
from places import BUNDLES
from processes import kill_engine
from study.played import Beside, Played, play

from aos_language.load import read_bundle_files
from aos_protocol.messages import BeliefRow, DecisionRecord, ModelAdopted, Steer
from aos_solver.child.engine import Engine
from aos_solver.mission import abandoning
from aos_solver.mission.loop import Mission
from aos_solver.study.comparing import Comparison, compared


async def comparisons(played: Played) -> list[Comparison]:
    async with played.replay(decides=True) as replay:
        return [
            row
            async for remade in replay.rows()
            if (row := compared(remade, replay.engine.build_digest, played.settings.time_s)) is not None
        ]


def files_of(bundle: Path) -> dict[str, bytes]:
    return read_bundle_files(bundle)[0]


async def kill_at_step_2(engine: Engine, step: int):
    if step == 2:
        await kill_engine(engine.pid)


@pytest.mark.parametrize(
    ("bundle", "budget"),
    [
        ("armadillo-finer", {}),
        ("armadillo-finer", {"planner": "pomcp", "simulations": 2000, "threads": 3}),
        ("bench/laser-normal", {"simulations": 300}),
    ],
    ids=["exact", "three threads", "particles"],
)
async def test_decisions_repeat_in_values_counts_and_beliefs(bundle, budget: dict[str, object]):
    played = await play(files_of(BUNDLES / bundle), steps=4, **budget)
    found = await comparisons(played)
    assert [row.difference for row in found if row.difference] == []
    assert all(row.has_values for row in found if row.decides)
    assert all(row.has_belief for row in found)


async def test_a_killed_engine_and_other_documents_are_replayed_where_they_happened():
    files = files_of(BUNDLES / "armadillo-finer")
    other = files | {"pick.sd": files["pick.sd"].replace(b"__reward = -2", b"__reward = -3")}
    assert other != files
    played = await play(
        files,
        steps=6,
        then=(3, other),
        beside=Beside(disturbance=kill_at_step_2),
        planner="pomcp",
        simulations=1000,
    )
    decisions = played.mission.decisions
    assert [each.engine_starts for each in decisions[:3]] == [1, 1, 2]
    assert len(list(played.mission.of_kind(ModelAdopted))) == 1
    found = await comparisons(played)
    assert [row.difference for row in found if row.difference] == []


async def test_a_search_that_was_given_up_leaves_nothing_that_a_replay_would_need(monkeypatch):
    """The hold comes when the third search has begun; without a grace it is given up."""
    monkeypatch.setattr(abandoning, "GRACE_S", 0.0)

    def steer(mission: Mission):
        state = mission.state
        if state.phase == "planning" and state.step == 2 and not state.remark:
            mission.steer(Steer("hold", by="ana", request="1"))
        elif state.phase == "holding" and state.held_by:
            mission.steer(Steer("resume", by="ana", request="2"))

    played = await play(
        files_of(BUNDLES / "bench/laser-normal"), steps=4, beside=Beside(steering=steer), simulations=2000
    )
    decisions = played.mission.decisions
    assert [each.engine_starts for each in decisions] == [1, 1, 2, 2]
    assert [len(each.searches) for each in decisions] == [1, 1, 1, 1]
    found = await comparisons(played)
    assert [row.difference for row in found if row.difference] == []
    assert all(row.has_values for row in found if row.decides)


async def test_the_first_difference_is_named_with_its_cause():
    played = await play(files_of(BUNDLES / "armadillo-finer"), steps=3)
    place, row = next((n, r) for n, r in enumerate(played.rows) if r.kind == "decision")
    record = msgspec.json.decode(row.payload, type=DecisionRecord)
    first, *others = record.actions
    forged = msgspec.structs.replace(
        record, actions=(msgspec.structs.replace(first, q=first.q + 1e-9), *others)
    )
    played.rows[place] = row._replace(payload=msgspec.json.encode(forged).decode())
    differing = next(row for row in await comparisons(played) if row.difference)
    assert differing.step == 1
    assert first.action in differing.difference
    assert differing.cause == "belief, budget and seed are the same"


async def test_a_budget_in_time_is_compared_by_its_beliefs():
    played = await play(files_of(BUNDLES / "armadillo-finer"), steps=3, planner="pomcp", time_s=0.02)
    found = await comparisons(played)
    assert [row.difference for row in found if row.difference] == []
    assert all(row.has_belief and not row.has_values for row in found)
    assert all("0.02 s" in row.without for row in found if row.decides)


async def test_the_journal_has_whole_beliefs_that_an_engine_takes():
    played = await play(files_of(BUNDLES / "armadillo-finer"), steps=2)
    rows = list(played.mission.of_kind(BeliefRow))
    assert [row.step for row in rows] == [0, 1, 2]
    async with played.replay() as replay:
        await replay.go_to(2)
        believed = await replay.engine.export_beliefs()
    assert believed.words == rows[1].words
    assert [b.particles for b in believed.beliefs] == [b.particles for b in rows[1].beliefs]


async def test_a_prediction_changes_no_particle():
    played = await play(files_of(BUNDLES / "bench" / "laser-normal"), steps=2, simulations=100)
    async with played.replay() as replay:
        await replay.go_to(2)
        before = await replay.engine.export_belief()
        for index in range(3):
            await replay.engine.predict(index)
        assert await replay.engine.export_belief() == before
