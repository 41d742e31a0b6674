"""One mission that was run for its record: what was done, what came back, how it ended."""

from __future__ import annotations

import msgspec

__all__ = ["NOTHING_OBSERVED", "Trial"]

NOTHING_OBSERVED = "no observation"
"""What stands in a step that brought none; no response has a space."""


class Trial(msgspec.Struct, frozen=True, kw_only=True):
    """A mission of one seed.

    `ending` is why it stopped. `goal` says whether the goal was reached: in the model's world where the model
    played it, else as the last belief has it, since nobody tells a robot. A response is empty where an
    activation brought no observation. `states` are texts of the world's truth after each action, where it is
    known. `value` is the discounted return, which only a model counts. A mission that broke has its `fault`.
    """

    seed: int
    ending: str
    goal: bool
    actions: tuple[str, ...] = ()
    responses: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    value: float | None = None
    seconds: float = 0.0
    fault: str = ""

    @property
    def steps(self) -> list[str]:
        """Each action with what came back, as `pick > success`, or `pick > no observation`."""
        return [
            f"{action} > {told or NOTHING_OBSERVED}"
            for action, told in zip(self.actions, self.responses, strict=True)
        ]
