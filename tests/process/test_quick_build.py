from pathlib import Path
from unittest.mock import AsyncMock

import msgspec
import pytest
from kept_cache import link_engines
from places import BUNDLES
from projects import bundle_project
from scripted_models import lowered

from aos_protocol.errors import ModelError
from aos_solver.building.build import BuildKind, BuiltModel, build
from aos_solver.building.project_build import emitted_model
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine


async def test_both_builds_decide_alike_and_the_thorough_one_is_taken_where_it_is_there(
    cache_dir: Path, tmp_path
):
    emitted, _ = lowered(bundle_project(BUNDLES / "armadillo-finer"))
    found: list[BuiltModel] = []
    kinds: tuple[BuildKind, ...] = ("quick", "thorough")
    for kind in kinds:
        # Models that earlier tests have built thoroughly are not there.
        kept = cache_dir / f"{kind}-builds"
        link_engines(cache_dir, kept)
        entry = (await build(emitted, cache_dir=kept, kind=kind)).executable.parent
        (tmp_path / entry.name).symlink_to(entry)
        found.append(await build(emitted, cache_dir=tmp_path, kind=kind))
    quick, thorough = found
    assert quick.executable != thorough.executable
    assert (await build(emitted, cache_dir=tmp_path)).executable == thorough.executable
    assert await decided(quick) == await decided(thorough)
    assert await mean_reward(quick) == pytest.approx(await mean_reward(thorough), abs=0.3)


async def test_only_the_deadline_counts_before_the_speed_of_the_machine_is_known(tmp_path, monkeypatch):
    limits: list[int | None] = []

    async def compiled(*_: object, cpu_s: int | None = None, **__: object) -> tuple[str, int]:
        limits.append(cpu_s)
        return "stopped by the test", 1

    monkeypatch.setattr("aos_solver.building.build.run_compiler", compiled)
    monkeypatch.setattr("aos_solver.building.build.build_engine", AsyncMock())
    emitted, _ = lowered(bundle_project(BUNDLES / "armadillo-finer"))
    with pytest.raises(ModelError, match="stopped by the test"):
        await build(emitted, cache_dir=tmp_path)
    assert set(limits) == {None}


def test_documents_that_come_back_are_not_emitted_again():
    first, again = (emitted_model(bundle_project(BUNDLES / "armadillo-finer")) for _ in range(2))
    assert again is first


def untimed(plan: Plan) -> Plan:
    return msgspec.structs.replace(plan, seconds=0, cpu_seconds=0, preparation_s=0, search_s=0)


async def decided(built: BuiltModel) -> list[Plan | BeliefUpdate]:
    """Returns what an engine says that depends on neither time nor machine: plans, and a belief between
    them."""
    async with await Engine.start(built, seed=7) as engine:
        before = await engine.plan(simulations=5000, seed=3, planner="pomcp")
        update = await engine.update(before.actions[before.index].action, "DefaultObservation")
        after = await engine.plan(simulations=5000, seed=4, planner="pomcp")
    return [untimed(before), update, untimed(after)]


async def mean_reward(built: BuiltModel) -> float:
    """Returns the mean of random steps: a quick build takes them one by one, a thorough one many at a
    time."""
    async with await Engine.start(built, seed=7) as engine:
        return (await engine.rate(0.05, seed=5)).mean_reward
