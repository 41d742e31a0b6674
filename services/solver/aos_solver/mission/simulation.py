"""Whole missions without a robot: the world is a hidden state that the documents' own model steps.

The stop rules are the mission loop's. Rewards are the model's, so that returns can be compared. A mission
with a robot knows its belief alone; here the world is known too, and so whether the belief was right.
"""

from __future__ import annotations

import msgspec

from aos_protocol.errors import DocumentError
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.endings import (
    Ending,
    MissionLimits,
    believed_ending,
    ending_after_planning,
    ending_of_belief,
)
from aos_solver.mission.risk import RiskBudget

__all__ = ["SimulatedRun", "simulate_mission"]


class SimulatedRun(msgspec.Struct, frozen=True, rename={"total": "return"}):
    """One mission: `total` is the undiscounted return (`return` in JSON).

    `ending` is why it stopped: what the belief called for, or the world's end where the belief has not
    noticed it. `world_ending` is the truth: how the world has ended, None where it has not. `believed_ending`
    is what the last belief held for sure enough. `numbers` are what was observed beside each response,
    where a model reports any. `states` are texts of the world's state before the first action and after each,
    where they were wanted. `violated` are the mission's constraints that were violated in the world, and
    `risked` is what the decisions took of each constraint's budget.
    """

    seed: int
    total: float
    discounted_return: float
    ending: Ending
    steps: int
    actions: tuple[str, ...]
    observations: tuple[str, ...]
    states: tuple[str, ...] = ()
    world_ending: Ending | None = None
    believed_ending: Ending | None = None
    numbers: tuple[dict[str, float | list[float | None]], ...] = ()
    violated: tuple[str, ...] = ()
    risked: dict[str, float] = {}


async def simulate_mission(
    engine: Engine,
    search: Search,
    limits: MissionLimits,
    *,
    with_states: bool = False,
    world: Engine | None = None,
) -> SimulatedRun:
    """Runs one mission from the initial belief; `search.seed` also draws the world.

    `world` plays the world where the robot's model may be wrong about it: the engine of other documents with
    the same actions. Rewards and endings are then theirs.
    """
    belief = await engine.reset_belief()
    world = world or engine
    places = {action.name: index for index, action in enumerate(world.description.actions)}
    world_ending = (await world.reset_world(search.seed)).ending
    discount = engine.description.discount
    total = discounted = 0.0
    actions: list[str] = []
    observations: list[str] = []
    numbers: list[dict[str, float | list[float | None]]] = []
    states = [await world.world_state()] if with_states else []
    budget, violations = RiskBudget(engine.bounds), 0
    risked: dict[str, float] = {bound.never: 0.0 for bound in engine.bounds}
    while True:
        ending = ending_of_belief(belief, len(actions), limits)
        if ending is None and world_ending:
            ending = Ending(world_ending)
        risks = await engine.risks(search.seed_of(len(actions) + 1)) if ending is None and budget else None
        forbidden = budget.forbidden(risks) if risks is not None else frozenset[int]()
        if forbidden and len(forbidden) == len(engine.description.actions):
            ending = Ending.TOO_RISKY
        if ending is None:
            plan = await search.run(engine, len(actions) + 1, sorted(forbidden))
            ending = ending_after_planning(plan.best, plan.actions, limits)
        if ending is not None:
            return SimulatedRun(
                search.seed,
                total,
                discounted,
                ending,
                len(actions),
                tuple(actions),
                tuple(observations),
                tuple(states),
                Ending(world_ending) if world_ending else None,
                believed_ending(belief, limits),
                tuple(numbers) if any(numbers) else (),
                tuple(each.never for number, each in enumerate(engine.bounds) if violations >> number & 1),
                risked,
            )
        for spent in budget.spend(risks, plan.index) if risks is not None else ():
            risked[spent.never] += spent.risk
        if plan.best.action not in places:
            raise DocumentError(
                f"the world's documents have no action {plan.best.action}", hint="Name others"
            )
        step = await world.step_world(places[plan.best.action])
        violations |= step.violations
        total += step.reward
        discounted += discount ** len(actions) * step.reward
        actions.append(plan.best.action)
        observations.append(step.response)
        numbers.append(step.numbers)
        if with_states:
            states.append(await world.world_state())
        belief = (await engine.update(plan.best.action, step.response, numbers=step.numbers)).summary
        world_ending = step.ending
