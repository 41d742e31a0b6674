"""The ledger of calls: at most one motion for each id, whatever is sent twice or crashes.

A repeat of an ended id gets the stored answer, or the same error. A repeat of one that started and never
ended gets "outcome unknown", and nothing moves, unless it runs: then whoever carries the ledger lets it join.
"""

from __future__ import annotations

from pathlib import Path

from aos_protocol.errors import AosError, SkillError, error_from_code
from aos_protocol.messages import ActivationId, Fault, Message, SkillCall, SkillResult
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import is_before


class _Failure(Message, frozen=True):
    id: ActivationId
    fault: Fault


class Ledger:
    """The calls of an adapter and how they ended, in a journal, so that they outlive the process."""

    def __init__(self, path: Path) -> None:
        # After a loss of power no mission goes on, and its ids are never used again.
        self._journal = Journal.open(path, survives_power_loss=False)
        self._started: dict[ActivationId, SkillCall] = {}
        self._ended: dict[ActivationId, SkillResult | Fault] = {}
        self._mission = ""
        for row in self._journal.rows():
            if row.kind == "started":
                self._take(row.read_as(SkillCall))
            elif row.kind == "ended":
                result = row.read_as(SkillResult)
                self._ended[result.id] = result
            elif row.kind == "failed":
                failure = row.read_as(_Failure)
                self._ended[failure.id] = failure.fault

    def stored(self, id: ActivationId) -> SkillResult | None:
        """The answer to an id that has ended; None for a new one.

        The error with which it ended, or SkillError AOS504.
        """
        ended = self._ended.get(id)
        if isinstance(ended, Fault):
            raise error_from_code(ended.code, ended.message, hint=ended.hint)
        if ended is not None:
            return ended
        if id in self._started:
            hint = "Let the robot sense what became of it"
            raise SkillError(f"activation {id} started and was never seen to end", code="AOS504", hint=hint)
        return None

    def calls(self) -> tuple[SkillCall, ...]:
        """Every call that was started, in order."""
        return tuple(self._started.values())

    def start(self, call: SkillCall) -> None:
        """Notes a call; it is called before anything moves."""
        self._journal.append("started", call)
        self._take(call)

    def end(self, result: SkillResult) -> None:
        """Notes a result; it is called after the robot moved."""
        self._journal.append("ended", result)
        self._ended[result.id] = result

    def fail(self, id: ActivationId, error: AosError) -> None:
        """Notes an error; it is called after the robot moved and failed."""
        fault = Fault(error.code, error.message, error.hint)
        self._journal.append("failed", _Failure(id, fault))
        self._ended[id] = fault

    def close(self) -> None:
        self._journal.close()

    def _take(self, call: SkillCall) -> None:
        """Those of missions before it in the same system are on the disk, and nobody asks for them."""
        mission = call.id.mission
        if mission != self._mission:
            self._mission = mission
            self._started = {id: of for id, of in self._started.items() if not is_before(id.mission, mission)}
            self._ended = {id: of for id, of in self._ended.items() if not is_before(id.mission, mission)}
        self._started[call.id] = call
