"""The call that an adapter runs: what is told of its progress, and the ledger of how calls ended."""

import asyncio
from collections.abc import Callable
from pathlib import Path

from aos_protocol.errors import AosError, SkillError, error_from_code
from aos_protocol.messages import ActivationId, Fault, SkillCall, SkillProgress, SkillResult
from aos_runtime.adapters.adapter import Answer, Call
from aos_runtime.disk.ledger import Failure, Ledger

PROGRESS_EVERY_S = 0.05
"""Progress is told this often; of what comes faster, the newest."""


class RunningCall:
    """The call that runs; each progress of it goes to `tell`. One that is `stuck` was given up for good."""

    def __init__(self, call: Call, task: asyncio.Task[Answer], tell: Callable[[SkillProgress], None]) -> None:
        self.call = call
        self.task = task
        self.ended = asyncio.Event()
        self.reason = ""
        self.stuck = asyncio.Event()
        self._tell = tell
        self._progress = 0.0
        self._reported_s = float("-inf")

    def tell(self, state: str, text: str = "") -> None:
        """Tells what state the call is in."""
        self._tell(SkillProgress(self.call.id, self.call.path, state, self._progress, text))

    def advance(self, progress: float, text: str) -> None:
        """Tells how far it has come, unless that was told a moment ago."""
        now_s = asyncio.get_running_loop().time()
        if now_s < self._reported_s + PROGRESS_EVERY_S:
            return
        self._reported_s = now_s
        self._progress = min(max(progress, 0.0), 1.0)
        self.tell("executing", text)


def last_progress(call: Call, error: AosError | None) -> SkillProgress:
    """The progress that is told of a call that has ended, with an error or without."""
    if error is None:
        return SkillProgress(call.id, call.path, "succeeded", 1.0, "")
    state = error.status if error.status in ("timed_out", "cancelled") else "failed"
    return SkillProgress(call.id, call.path, state, 0.0, error.message)


class CallLedger(Ledger[SkillCall, SkillResult | Failure]):
    """The calls of an adapter and how they ended, in a journal, so that they outlive the process.

    There is at most one motion for each id. A repeat of an ended id gets the stored answer, or the same
    error. A repeat of one that started and never ended gets "outcome unknown", and nothing moves, unless it
    runs: then whoever carries the ledger lets it join.
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, SkillCall, {"ended": SkillResult, "failed": Failure})

    def stored(self, id: ActivationId) -> SkillResult | None:
        """The answer to an id that has ended; None for a new one.

        The error with which it ended, or SkillError AOS504.
        """
        ended = self._ended.get(id)
        if isinstance(ended, Failure):
            raise error_from_code(ended.fault.code, ended.fault.message, hint=ended.fault.hint)
        if ended is None and self.was_started(id):
            hint = "Let the robot sense what became of it"
            raise SkillError(f"activation {id} started and was never seen to end", code="AOS504", hint=hint)
        return ended

    def fail(self, id: ActivationId, error: AosError) -> None:
        """Notes an error; it is called after the robot moved and failed."""
        self.end(Failure(id, Fault(error.code, error.message, error.hint)), "failed")
