"""Waiting for a state that a service tells when it changes and gives to whoever asks."""

from collections.abc import Callable
from typing import TypeVar

from aos_protocol.errors import BusError, LateAnswerError, LostAnswerError, NobodyAnswersError
from aos_protocol.messages import Message
from aos_runtime.bus.bus import Bus
from aos_runtime.older_python import timeout

M = TypeVar("M", bound=Message)

_QUESTION_S = 5.0
_AGAIN_S = 1.0
"""A service that has told nothing for so long is asked again."""

_IS_AWAY = (NobodyAnswersError, LostAnswerError, LateAnswerError)
"""An asker gets these errors from a service that starts, stops or is busy: it tells its state when it has
one."""


async def state_when(
    bus: Bus, key: str, question: Message, kind: type[M], holds: Callable[[M], bool], *, timeout_s: float
) -> M:
    """The first state on `key` for which `holds`, told already or from now on.

    `key` is a stream of states and answers `question` with the present one; its service may come later.
    LateAnswerError if no such state is told within `timeout_s`, BusError AOS605 if the bus is left.
    """
    try:
        async with timeout(timeout_s), bus.listen(key, kind) as states:
            while True:
                try:
                    state = await bus.ask(key, question, kind, timeout_s=min(timeout_s, _QUESTION_S))
                except _IS_AWAY:
                    pass
                else:
                    if holds(state):
                        return state
                try:
                    async with timeout(_AGAIN_S):
                        async for _, state in states:
                            if holds(state):
                                return state
                except TimeoutError:
                    continue  # What it told while the router was away is lost.
                break
    except TimeoutError:
        raise LateAnswerError(f"what is awaited on {key} did not come in {timeout_s:g} s") from None
    raise BusError(f"{bus.sender} has left the bus", code="AOS605")
