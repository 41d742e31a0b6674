"""The models that a mission had, one after the other: the belief of one that is taken up came through them.

A model that took over by replay has the belief that its own replay of the past gives, whatever ran before it.
One that took over by import or projection has got its belief from the model before it.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from typing import NamedTuple

import msgspec

from aos_protocol.messages import MissionBegun, ModelAdopted, TakeoverWay
from aos_runtime.clock import SystemClock
from aos_solver.child.answers import BeliefUpdate
from aos_solver.mission.past import Past, replayed
from aos_solver.mission.takeover import RunningModel, Successor

__all__ = ["Earlier", "Stretch", "after", "models_before", "retraced"]


class Stretch(msgspec.Struct, frozen=True):
    """The model of some steps of a mission. It came to its belief `by` this way after so many `steps`."""

    revision: int
    model_digest: str
    by: TakeoverWay
    steps: int


class Earlier(NamedTuple):
    """A model that another one followed, after so many steps of the mission."""

    model: RunningModel
    until: int


def after(
    stretches: tuple[Stretch, ...], said: MissionBegun | ModelAdopted, steps: int
) -> tuple[Stretch, ...]:
    """The stretches after a row of the journal which `steps` steps are before."""
    if isinstance(said, ModelAdopted):
        return (*stretches, Stretch(said.revision, said.model_digest, said.by, steps))
    if not said.is_retraced:
        return (Stretch(said.revision, said.model_digest, "replay", steps),)
    if stretches and stretches[-1].model_digest == said.model_digest:
        return stretches
    return (*stretches, Stretch(said.revision, said.model_digest, "import", steps))


def models_before(
    stretches: Sequence[Stretch], model_digest: str, steps: int
) -> tuple[tuple[Stretch, int], ...]:
    """The stretches that the belief of a model came through, each with the step at which it ended.

    The model takes the mission up after `steps` steps. Empty where it replays the past by itself.
    """
    if not stretches:
        return ()
    first = max((place for place, each in enumerate(stretches) if each.by == "replay"), default=0)
    needed = list(stretches[first:])
    ends = [each.steps for each in needed[1:]]
    if needed[-1].model_digest == model_digest:
        return tuple(zip(needed[:-1], ends, strict=True))
    return tuple(zip(needed, [*ends, steps], strict=True))


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
