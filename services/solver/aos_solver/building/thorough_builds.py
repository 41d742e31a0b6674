"""Thorough builds of models that run: into the cache, for the next start, while a mission uses a quick build.

Within a mission a thorough build would win less than is lost with the search tree, which does not move over.
"""

import asyncio
import logging
from pathlib import Path
from typing import Any

from aos_protocol.errors import AosError
from aos_runtime.background import Background
from aos_solver.building.build import build
from aos_solver.emission.emit import EmittedModel

log = logging.getLogger(__name__)

_LAST = 19
"""The niceness of what nobody waits for: of all that wants a processor it is served last."""

_UNHURRIED_DEADLINE_S = 1800.0

_AFTER_S = 5.0
"""A mission that ends before that has the processors to itself: its build would be killed half-way."""


class ThoroughBuilds:
    """Builds beside everything else."""

    def __init__(self, cache_dir: Path, after_s: float = _AFTER_S) -> None:
        self._cache_dir = cache_dir
        self._after_s = after_s
        self._builds = Background()

    @property
    def tasks(self) -> set[asyncio.Task[Any]]:
        """The builds that have not ended."""
        return self._builds.tasks

    def begin(self, emitted: EmittedModel) -> None:
        """Begins a build when the time has gone by."""
        self._builds.begin(self._build(emitted))

    def end(self) -> None:
        """Has them end. Nobody waits for that before the end: what is served last ends late, too."""
        for task in self.tasks:
            # A second cancel would break off the wait for the compiler that the first one has killed.
            if not task.cancelling():
                task.cancel()

    async def _build(self, emitted: EmittedModel) -> None:
        """Builds into the cache. Nobody waits for it: all other work goes first, and a fault is logged."""
        await asyncio.sleep(self._after_s)
        try:
            await build(
                emitted,
                cache_dir=self._cache_dir,
                kind="thorough",
                niceness=_LAST,
                deadline_s=_UNHURRIED_DEADLINE_S,
            )
        except AosError as error:
            log.warning("%s was not built thoroughly: %s", emitted.project, error)
        except Exception:
            log.exception("%s was not built thoroughly", emitted.project)
