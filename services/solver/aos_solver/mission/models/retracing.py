"""The models that a mission had, one after the other, and how a belief goes through them."""

from collections.abc import AsyncIterator, Sequence
from typing import NamedTuple

from aos_runtime.clock import SystemClock
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.mission.models.past import Past, replayed
from aos_solver.mission.models.takeover import RunningModel, Successor


class Earlier(NamedTuple):
    """A model that another one followed, after so many steps of the mission."""

    model: RunningModel
    until: int


async def retraced(
    earlier: Sequence[Earlier], model: RunningModel, past: Past, known: int = 0
) -> AsyncIterator[BeliefUpdate]:
    """Updates beliefs by each step from `known` on, through the earlier models and then this one.

    Each earlier engine is closed once the next one has its belief, or the walk ends. AosError where a model
    cannot take over as it did.
    """
    models = [*(each.model for each in earlier), model]
    number = known
    try:
        for (before, until), follower in zip(earlier, models[1:], strict=True):
            stretch = Past(past.refuted_below, past.steps[: known + until])
            async for update in replayed(before.engine, stretch, number):
                number += 1
                yield update
            successor, takeover = Successor(follower, SystemClock()), None
            while takeover is None:
                takeover = await successor.take_over(before, stretch)
            await before.engine.close()
        async for update in replayed(model.engine, past, number):
            yield update
    finally:
        for before, _ in earlier:
            await before.engine.close()
