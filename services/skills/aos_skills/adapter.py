"""What an adapter is: it turns calls into motion, and the robot's data into topics.

The service owns one adapter of each kind that the deploy file binds a path to.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from aos_protocol.messages import ActivationId

__all__ = ["Adapter", "Publish"]

Publish = Callable[[str, dict[str, Any]], None]
"""Sends the fields of one message on a topic path. May be called from any thread."""


class Adapter(Protocol):
    """Calls come one at a time."""

    @property
    def paths(self) -> frozenset[str]:
        """The activation paths that it serves."""
        ...

    async def prepare(self) -> None:
        """Returns when it could run a call at once; raises if it never can. Calls may come before."""
        ...

    async def call(
        self, id: ActivationId, path: str, fields: dict[str, Any], deadline_s: float
    ) -> dict[str, Any]:
        """Runs a skill to its end and gives the answer's fields.

        SkillError AOS502 if the skill cannot run, AOS503 if it takes longer than `deadline_s`, AOS507 if it
        was cancelled; the robot stands still afterwards.
        """
        ...

    def cancel(self) -> None:
        """Asks what moves to stop at once."""
        ...

    async def close(self) -> None:
        """Ends the adapter."""
        ...
