"""The registry as other services see it: the newest documents of a project, and those of each revision."""

import contextlib
import logging
from collections.abc import Awaitable, Callable

from aos_protocol.documents import Project
from aos_protocol.errors import AosError, LateAnswerError
from aos_protocol.keys import Keys
from aos_protocol.messages import ProjectQuery, ProjectRevision
from aos_runtime.bus.bus import Bus

log = logging.getLogger(__name__)

ASK_TIMEOUT_S = 5.0


class RegistryWatch:
    """Asks for the documents of one project; each newest revision goes to `adopt`."""

    def __init__(
        self, bus: Bus, keys: Keys, project: str, adopt: Callable[[ProjectRevision], Awaitable[None]]
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._project = project
        self._adopt = adopt

    async def follow(self) -> None:
        """Asks for the documents, and again when the registry comes: what it told meanwhile is lost."""
        await self._adopt_when_told()
        async with self._bus.presence(self._keys.live("registry")) as presence:
            async for _, is_there in presence:
                if is_there:
                    await self._adopt_when_told()

    async def adopt_current(self) -> None:
        """Gives what the registry holds already. Where it holds nothing, an announcement will come."""
        with contextlib.suppress(LateAnswerError):
            await self._adopt_if_told()

    async def _adopt_when_told(self) -> None:
        """Asks until the registry has said what it holds: nothing else would tell of it once more."""
        while True:
            with contextlib.suppress(LateAnswerError):
                return await self._adopt_if_told()

    async def _adopt_if_told(self) -> None:
        """Gives what the registry holds, if it holds any; LateAnswerError if it does not say so in time."""
        try:
            revision = await self._ask(ProjectQuery(self._project))
        except AosError as error:
            log.info("no documents yet: %s", error.message)
            if isinstance(error, LateAnswerError):
                raise
            return
        await self._adopt(revision)

    async def documents(self, revision: int) -> Project:
        return (await self._ask(ProjectQuery(self._project, revision))).project

    async def files(self, revision: int) -> dict[str, bytes]:
        return (await self._ask(ProjectQuery(self._project, revision, with_files=True))).files

    async def _ask(self, query: ProjectQuery) -> ProjectRevision:
        return await self._bus.ask(self._keys.project, query, ProjectRevision, timeout_s=ASK_TIMEOUT_S)
