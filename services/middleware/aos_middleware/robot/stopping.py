"""The end of a call that is stopped while it runs: by its mapping's `stop_when`."""

import asyncio
import logging

from aos_protocol.errors import AosError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import Activate, Cancel, Cancelled
from aos_runtime.bus.bus import Bus

STOP_S = 3.0
"""An adapter has this long to answer that what it is to stop has stopped, before it is asked again."""

_FIRST_PAUSE_S = 0.02
_LONGEST_PAUSE_S = 1.0

_log = logging.getLogger("aos.middleware")


class Stop:
    """Stops one call. `by` names the skill whose mapping stops it, and is empty while nothing does."""

    def __init__(self, bus: Bus, keys: Keys, request: Activate, path: str) -> None:
        self.by = ""
        self._bus = bus
        self._key = keys.cancel(path)
        self._request = request
        self._is_asked = asyncio.Event()
        self._goes_out = asyncio.Event()
        self._came_first = False

    def ask(self, by: str) -> None:
        """Has the call stopped; whoever asks first is named."""
        if not self.by:
            self.by = by
            self._is_asked.set()
            _log.info("%s is stopped: %s", self._request.id, self.reason)

    @property
    def reason(self) -> str:
        return f"{self._request.skill}: stop_when of {self.by} holds"

    def let_out(self) -> None:
        """Lets the call go out; SkillError AOS502 where it is to be stopped already."""
        if self.by:
            self._came_first = True
            raise SkillError(f"{self.reason} before it was called", hint=self._hint())
        self._goes_out.set()

    def is_cause(self, error: AosError) -> bool:
        """Returns whether a call ended with this error because it was stopped."""
        return self._came_first or (bool(self.by) and error.code == "AOS507")

    def unexplained(self, error: AosError) -> SkillError:
        """The error of a call that was stopped where no rule says what was observed."""
        return SkillError(
            f"{self.reason}, and no rule says what was observed", code=error.code, hint=self._hint()
        )

    async def follow(self) -> None:
        """Cancels the call as soon as that is asked for. Returns when its adapter says that it has stopped.

        A cancellation may overtake the call; the adapter, which knows no such call then, is asked again.
        """
        await self._goes_out.wait()
        await self._is_asked.wait()
        cancel = Cancel(self.reason, self._request.id, self._request.epoch)
        pause_s = _FIRST_PAUSE_S
        while True:
            try:
                answer = await self._bus.ask(self._key, cancel, Cancelled, timeout_s=STOP_S)
            except AosError as error:
                _log.warning("%s, and nobody says that it has stopped: %s", self.reason, error)
            else:
                if str(self._request.id) in answer.ids:
                    return
            await asyncio.sleep(pause_s)
            pause_s = min(2.0 * pause_s, _LONGEST_PAUSE_S)

    def _hint(self) -> str:
        return f"Give the mapping of {self._request.skill} a rule for `__skill_status == 'stopped'`"
