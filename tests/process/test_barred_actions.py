import pytest
from models import engine_of_bundle
from places import BUNDLES

from aos_solver.child.engine import Planner, Restriction


@pytest.mark.parametrize("planner", ["pomcp", "despot", "sarsop", "auto"])
async def test_a_barred_action_is_never_the_decision(planner: Planner):
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        barred: list[int] = []
        while len(barred) < 4:
            plan = await engine.plan(
                simulations=2000, seed=1, planner=planner, within=Restriction(barred=barred)
            )
            assert plan.index not in barred
            barred.append(plan.index)
        # Nothing of it stays: the next decision is free again.
        assert (await engine.plan(simulations=2000, seed=1, planner=planner)).index == barred[0]
