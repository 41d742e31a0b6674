"""The use of the gateway: whether a request is open or a mission runs, and when one last did."""

import asyncio
import time

from starlette.types import ASGIApp, Receive, Scope, Send

from aos_deploy.runs.living import living_runs

_LOOKS = 4
_LOOK_S = 5.0


class Use:
    """An application that knows since when nobody has asked it anything. A page that is open does ask."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._open = 0
        self._last_s = time.monotonic()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self._open += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._open -= 1
            self._last_s = time.monotonic()

    async def until_unused(self, for_s: float) -> None:
        """Returns once nobody has looked, and no mission of this machine has run, for so many seconds."""
        while time.monotonic() - self._last_s < for_s:
            await asyncio.sleep(min(for_s / _LOOKS, _LOOK_S))
            living = await asyncio.to_thread(living_runs)
            if self._open or living:
                self._last_s = time.monotonic()
