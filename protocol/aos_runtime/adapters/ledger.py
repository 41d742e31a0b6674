"""The ledger of calls: at most one motion for each id, whatever is sent twice or crashes.

A repeat of an ended id gets the stored answer, or the same error. A repeat of one that started and never
ended gets "outcome unknown", and nothing moves, unless it runs: then whoever carries the ledger lets it join.
"""

from pathlib import Path

from aos_protocol.errors import AosError, SkillError, error_from_code
from aos_protocol.messages import ActivationId, Fault, SkillCall, SkillResult
from aos_runtime.disk.ledger import Failure, Ledger


class CallLedger(Ledger[SkillCall, SkillResult | Failure]):
    """The calls of an adapter and how they ended, in a journal, so that they outlive the process."""

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
