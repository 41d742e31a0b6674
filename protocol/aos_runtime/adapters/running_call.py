"""The call that an adapter runs, and what is told of its progress."""

import asyncio
from collections.abc import Callable

from aos_protocol.errors import AosError
from aos_protocol.messages import SkillProgress
from aos_runtime.adapters.adapter import Answer, Call

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
