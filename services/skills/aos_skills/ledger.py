"""The ledger of activations: at most one motion for each id, whatever is sent twice or crashes.

A repeat of an ended id gets the stored answer. A repeat of one that started and never ended gets "outcome
unknown", and nothing moves. An older epoch than the highest seen is a stale solver and is refused.
"""

from __future__ import annotations

from pathlib import Path

import msgspec

from aos_protocol.errors import SkillError
from aos_protocol.messages import ActivationId, SkillCall, SkillResult
from aos_runtime.journal import Journal

__all__ = ["Ledger"]


class Ledger:
    """Kept in a journal, so that it outlives the process."""

    def __init__(self, path: Path) -> None:
        self._journal = Journal.open(path)
        self._started: set[ActivationId] = set()
        self._ended: dict[ActivationId, SkillResult] = {}
        for row in self._journal.rows("started"):
            self._started.add(msgspec.json.decode(row.payload, type=SkillCall).id)
        for row in self._journal.rows("ended"):
            result = msgspec.json.decode(row.payload, type=SkillResult)
            self._ended[result.id] = result

    def stored(self, id: ActivationId) -> SkillResult | None:
        """The answer to an id that has ended; None for a new one. SkillError AOS504 or AOS506 otherwise."""
        if id in self._ended:
            return self._ended[id]
        if id in self._started:
            raise SkillError(
                f"activation {id} started and was never seen to end",
                code="AOS504",
                hint="Let the robot sense what became of it",
            )
        epochs = [known.epoch for known in self._started if known.mission == id.mission]
        if epochs and id.epoch < max(epochs):
            raise SkillError(f"activation {id} comes from an older epoch", code="AOS506")
        return None

    def start(self, call: SkillCall) -> None:
        """Before anything moves."""
        self._journal.append("started", call)
        self._started.add(call.id)

    def end(self, result: SkillResult) -> None:
        """After it moved."""
        self._journal.append("ended", result)
        self._ended[result.id] = result

    def close(self) -> None:
        self._journal.close()
