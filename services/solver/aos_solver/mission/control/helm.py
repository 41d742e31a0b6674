"""The helm of a mission: takes what somebody wants of it, journals it, and answers who waits for it."""

import asyncio
from collections.abc import Callable

from aos_protocol.errors import AosError, SteeringError
from aos_protocol.messages import ActionRefused, DecisionRecord, MissionState, Steer
from aos_protocol.mission_rows import REFUSED, STEERED
from aos_protocol.spelling import did_you_mean, nearest
from aos_solver.child.answers.models import EngineDescription
from aos_solver.mission.control.steering import Asked, Steering
from aos_solver.mission.ports import Record

_REFUSED = "AOS518"


class Helm:
    """The steering of one mission. `now` is its state, and `turns` counts the changes of it by somebody.

    `on_change` hears of each change.
    """

    def __init__(self, steering: Steering, record: Record, on_change: Callable[[Steering], None]) -> None:
        self.now = steering
        self.turns = 0
        self._record = record
        self._on_change = on_change
        self._waiting: dict[str, asyncio.Future[None]] = {}

    @property
    def asked(self) -> Asked | None:
        """The action that is to be carried out next, where somebody asked for one."""
        return self.now.queue[0] if self.now.queue else None

    @property
    def left_out(self) -> dict[str, str]:
        """The skills and grounded actions to decide without, each with the reason."""
        return {name: f"{name} is left out by {by}" for name, by in self.now.left_out.items()}

    def take(self, steer: Steer, model: EngineDescription, *, is_holding: bool) -> bool:
        """Takes a question once, and returns whether it is new. SteeringError says why it cannot be done."""
        if steer.request and steer.request in self.now.requests:
            return False
        self._check(steer, model)
        self._record.journal(STEERED, steer)
        self.turns += 1
        self._change(self.now.after(steer, is_holding=is_holding))
        return True

    def decided(self, decision: DecisionRecord) -> None:
        """Takes note of a decision that is in the journal."""
        self._change(self.now.decided(decision))

    def observed(self, record: DecisionRecord) -> None:
        """Takes note of an outcome that is in the journal."""
        self._change(self.now.observed(record))

    def refuse(self, asked: Asked, why: str, hint: str) -> None:
        """Drops an action that cannot be carried out."""
        row = ActionRefused(asked.action, asked.request, why, hint)
        self._record.journal(REFUSED, row)
        self._change(self.now.refused(row))

    def end(self, state: MissionState) -> None:
        """Tells all who wait that the mission has ended."""
        for waiting in self._waiting.values():
            if not waiting.done():
                waiting.set_exception(SteeringError(f"the mission has ended before: {state.ending}"))

    async def until_decided(self, request: str) -> None:
        """Returns once nothing is left of a request; SteeringError AOS518 where it was refused."""
        if self.now.is_queued(request):
            future = self._waiting.setdefault(request, asyncio.get_running_loop().create_future())
            await asyncio.shield(future)
        if request in self.now.refusals:
            raise _refusal(self.now.refusals[request])

    def _change(self, steering: Steering) -> None:
        self.now = steering
        for request in [request for request in self._waiting if not steering.is_queued(request)]:
            waiting = self._waiting.pop(request)
            if not waiting.done():
                waiting.set_result(None)
        self._on_change(steering)

    def _check(self, steer: Steer, model: EngineDescription) -> None:
        names = [action.name for action in model.actions]
        if steer.verb in ("act", "script"):
            if not steer.actions or (steer.verb == "act" and len(steer.actions) > 1):
                raise SteeringError(f"`{steer.verb}` with {len(steer.actions)} actions")
            for number, action in enumerate(steer.actions, 1):
                where = f"action {number} of the script: " if steer.verb == "script" else ""
                if action not in names:
                    hint = _likely(action, names)
                    raise SteeringError(f"{where}there is no action {action}", hint=hint)
        elif steer.verb == "leave_out":
            known = [*dict.fromkeys(action.skill for action in model.actions), *names]
            if steer.name not in known:
                raise SteeringError(
                    f"there is no skill or action {steer.name}", hint=_likely(steer.name, known)
                )
        elif steer.verb == "take_back" and steer.name not in self.now.left_out:
            text = ", ".join(self.now.left_out) or "nothing"
            raise SteeringError(f"{steer.name} is not left out", hint=f"Left out is {text}")


def _likely(name: str, known: list[str]) -> str:
    if hint := did_you_mean(name, known):
        return hint
    skill = nearest(name.partition("(")[0], {action.partition("(")[0] for action in known})
    of_skill = [action for action in known if action.partition("(")[0] == skill]
    shown = ", ".join((of_skill or known)[:5])
    return f"There are {len(known)}: {shown}" if len(known) > 5 and not of_skill else f"There is {shown}"


def _refusal(row: ActionRefused) -> AosError:
    return SteeringError(f"{row.action} is refused: {row.why}", code=_REFUSED, hint=row.hint)
