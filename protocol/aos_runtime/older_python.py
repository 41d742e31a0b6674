"""The parts of newer Pythons that have to do with asyncio and that Python 3.10 lacks."""

from __future__ import annotations

import asyncio
import sys

__all__ = ["BaseExceptionGroup", "timeout"]

if sys.version_info >= (3, 11):
    from asyncio import timeout
    from builtins import BaseExceptionGroup
else:

    class BaseExceptionGroup(BaseException):
        """Nothing raises one there."""

        exceptions: tuple[BaseException, ...] = ()

    class timeout:
        """`asyncio.timeout`: TimeoutError when the block takes longer than `delay` seconds."""

        def __init__(self, delay: float | None) -> None:
            self._delay = delay
            self._is_over = False
            self._timer: asyncio.TimerHandle | None = None

        async def __aenter__(self) -> timeout:
            task = asyncio.current_task()
            assert task is not None
            self._task = task
            if self._delay is not None:
                self._timer = asyncio.get_running_loop().call_later(max(self._delay, 0.0), self._end)
            return self

        async def __aexit__(self, kind: type[BaseException] | None, *_: object) -> None:
            if self._timer is not None:
                self._timer.cancel()
            if self._is_over and kind is asyncio.CancelledError:
                raise TimeoutError from None

        def _end(self) -> None:
            self._is_over = True
            self._task.cancel()
