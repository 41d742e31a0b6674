"""The stretches of a mission: which model had which of its steps, by the rows of the journal.

A model that took over by replay has the belief that its own replay of the past gives, whatever ran before it.
One that took over by import or projection has got its belief from the model before it.
"""

from collections.abc import Sequence

import msgspec

from aos_protocol.messages import MissionBegun, ModelAdopted, TakeoverWay


class Stretch(msgspec.Struct, frozen=True):
    """The model of some steps of a mission. It came to its belief `by` this way after so many `steps`."""

    revision: int
    model_digest: str
    by: TakeoverWay
    steps: int


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
