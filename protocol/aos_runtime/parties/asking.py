"""Asking a service that may be started again before it has answered."""

import logging
from typing import TypeVar

from aos_protocol.errors import LostAnswerError, NobodyAnswersError
from aos_protocol.messages import Message
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.subscription import Subscription
from aos_runtime.older_python import timeout

AWAY_S = 30.0
"""A service may be away for so long before whoever asks it gives up."""

_AGAIN_S = 0.5
"""A service that is there, and has not taken a question, is asked again after this time."""

R = TypeVar("R", bound=Message)

_log = logging.getLogger("aos.bus")


async def ask_until_answered(
    bus: Bus, key: str, message: Message, reply: type[R], *, server: str, timeout_s: float
) -> R:
    """Asks again each time that the service whose presence is `server` has come back.

    The question must be one that may be asked twice. `timeout_s` is for each asking. Errors are those of
    `Bus.ask`; NobodyAnswersError and LostAnswerError come once the service was away for AWAY_S.
    """
    async with bus.presence(server) as presence:
        server_is = _Server(presence)
        while True:
            try:
                return await bus.ask(key, message, reply, timeout_s=timeout_s)
            except (NobodyAnswersError, LostAnswerError) as error:
                _log.info("%s; asked again when %s is back", error.message, server)
                if not await server_is.back():
                    raise


class _Server:
    """The presence of a service, as its token tells."""

    def __init__(self, presence: Subscription[tuple[str, bool]]) -> None:
        self._presence = presence
        self._is_there = False

    async def back(self) -> bool:
        """Returns once the service can be asked again; False if it stays away."""
        try:
            async with timeout(AWAY_S):
                while self._presence.has_items:
                    await self._hear()
                if self._is_there:
                    await self._may_leave()
                while not self._is_there:
                    await self._hear()
        except TimeoutError:
            return False
        return True

    async def _may_leave(self) -> None:
        """Waits a moment for news: a service that has not answered may be leaving, or may have come just
        now."""
        try:
            async with timeout(_AGAIN_S):
                await self._hear()
        except TimeoutError:
            pass

    async def _hear(self) -> None:
        _, self._is_there = await anext(self._presence)
