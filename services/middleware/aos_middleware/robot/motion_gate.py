"""One motion of the robot at a time, whichever processes move it."""

import asyncio
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from aos_middleware.robot.served_paths import ServedPaths
from aos_protocol.errors import AosError, LostAnswerError, NobodyAnswersError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import Activate, ActivationId, Cancel, Cancelled
from aos_runtime.bus.bus import Bus

CONFIRM_S = 3.0
"""A motion waits this long for word that an earlier skill has stopped."""

_AGAIN_S = 1.0
"""A skill that may still be moving is asked again after this time."""

GONE_S = 1.0
"""The token of a process that does not answer may still be there for this long."""

_log = logging.getLogger("aos.middleware")


class MotionGate:
    """Lets one call through at a time, and none while an earlier one may still be moving.

    `shut` is why nothing is let through: an earlier skill was asked whether it stands still, and did not say
    so. `on_change` is called when that changes.
    """

    def __init__(self, bus: Bus, keys: Keys, served: ServedPaths, on_change: Callable[[], None]) -> None:
        self.shut = ""
        self._on_change = on_change
        self._has_shut = asyncio.Event()
        self._bus = bus
        self._keys = keys
        self._served = served
        self._moving = ""
        self._doubts: dict[ActivationId, tuple[str, int]] = {}

    @contextmanager
    def passing(self, path: str) -> Iterator[None]:
        """While the block runs, nothing else may move. SkillError AOS502 if something does."""
        if self._moving:
            raise SkillError(f"{path} is refused: {self._moving} is running", hint="One skill runs at a time")
        self._moving = path
        try:
            yield
        finally:
            self._moving = ""

    def doubt(self, request: Activate, path: str) -> None:
        """Nobody has said that this call has ended."""
        self._doubts[request.id] = path, request.epoch

    async def follow(self) -> None:
        """Asks again and again, while it is shut, whether what was called before stands still."""
        while await self._has_shut.wait():
            await asyncio.sleep(_AGAIN_S)
            with suppress(SkillError):
                await self.confirm()

    async def confirm(self) -> None:
        """Returns when everything that was called before stands still; SkillError AOS512 if nobody says so.

        Whoever has left the bus moves nothing any more, as far as can be known.
        """
        for activation, (path, epoch) in list(self._doubts.items()):
            if self._served.servers(path):
                await self._confirm(Cancel("another skill is to run", activation, epoch), path)
            if self._doubts.pop(activation, None):
                _log.info("%s of %s has stopped", path, activation)
        self._turn("")

    def _turn(self, shut: str) -> None:
        if bool(shut) is not bool(self.shut):
            self.shut = shut
            (self._has_shut.set if shut else self._has_shut.clear)()
            self._on_change()

    async def _confirm(self, cancel: Cancel, path: str) -> None:
        try:
            await self._bus.ask(self._keys.cancel(path), cancel, Cancelled, timeout_s=CONFIRM_S)
        except AosError as error:
            is_gone = isinstance(error, NobodyAnswersError | LostAnswerError)
            if is_gone and await self._served.has_left(path, GONE_S):
                return
            said = f"{path} may still be moving: it does not say that it has stopped ({error.message})"
            hint = "See the log of its adapter, which has to answer cancellations, or end it"
            self._turn(f"{said}. {hint}")
            raise SkillError(said, code="AOS512", hint=hint) from error
