import pytest
from models import engine_of

from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.models import Plan


async def test_a_short_look_ahead_has_the_tigers_exact_value(tiger: BuiltModel):
    async with engine_of(tiger) as engine:
        exact = {value.action: value.q for value in (await engine.exact_values(4)).actions}
        plan = await engine.plan(simulations=200_000, seed=2, horizon=4, planner="pomcp")
    assert plan.best.q == pytest.approx(max(exact.values()), abs=0.3)
    assert exact[plan.best.action] == max(exact.values())


async def test_threads_that_share_a_budget_repeat_to_the_bit(tiger: BuiltModel):
    async def decide() -> Plan:
        async with engine_of(tiger) as engine:
            await engine.plan(simulations=5_001, seed=4, threads=3, planner="pomcp")
            await engine.update("listen", "tiger_left")
            return await engine.plan(simulations=5_001, seed=5, threads=3, planner="pomcp")

    first, again = await decide(), await decide()
    assert first.actions == again.actions
    assert first.simulations == 5_001
    assert first.known_simulations == again.known_simulations > 0


async def test_threads_decide_as_one_thread_does(tiger: BuiltModel):
    plans = []
    for threads in (1, 2):
        async with engine_of(tiger) as engine:
            plans.append(
                await engine.plan(simulations=100_000, seed=1, horizon=2, threads=threads, planner="pomcp")
            )
    alone, together = plans
    assert together.index == alone.index
    assert together.best.q == pytest.approx(alone.best.q, abs=0.03)


async def test_pondering_while_acting_leaves_a_warm_start_and_stops_when_it_is_asked(tiger: BuiltModel):
    async with engine_of(tiger) as engine:
        await engine.plan(simulations=100, seed=1, planner="pomcp")
        await engine.update("listen", "tiger_left")
        idle = await engine.plan(simulations=100, seed=2, planner="pomcp")
        await engine.ponder(idle.index, seed=3, time_s=0.2)
        predicted = await engine.predict(idle.index)  # What is asked now ends the pondering...
        await engine.ponder(idle.index, seed=3, time_s=60)
        await engine.update(idle.best.action, predicted.predicted[0].response)  # ...and so does this.
        warm = await engine.plan(simulations=100, seed=4, planner="pomcp")
    assert warm.known_simulations > idle.known_simulations
