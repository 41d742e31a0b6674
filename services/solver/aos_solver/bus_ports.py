"""The ports of a mission on bus and disk: the robot through the middleware, the journal, the models."""

import asyncio
import contextlib

from aos_protocol.messages import Activate, DecisionRecord, Message, MissionState, Outcome
from aos_runtime.parties.asking import ask_until_answered
from aos_runtime.processes.lifecycle import Service
from aos_solver.mapping_watch import MappingWatch
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import RunningModel, Takeover
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.mission.rules.endings import Ending
from aos_solver.settings import Settings

ACTIVATION_MARGIN_S = 20.0
"""An answer may take this much longer than the activation itself: its time begins once its mapping
runs and monitors listen."""


class BusPorts:
    """The `Ports` of each mission of a solver. `changed` is set when a mission may have to look again."""

    world_ending: Ending | None = None
    keeps_beliefs: bool = True

    def __init__(
        self,
        service: Service[Settings],
        books: Logbooks,
        mappings: MappingWatch,
        shelf: ModelShelf,
        changed: asyncio.Event,
    ) -> None:
        self.clock = service.clock
        self._bus = service.bus
        self._keys = service.keys
        self._books = books
        self._mappings = mappings
        self._shelf = shelf
        self._changed = changed

    @property
    def unavailable(self) -> dict[str, str]:
        return self._mappings.unavailable

    @property
    def returning(self) -> tuple[str, ...]:
        return self._mappings.returning

    @property
    def announced(self) -> dict[str, int]:
        return self._mappings.announced

    async def until_changed(self, timeout_s: float) -> None:
        # A change that came before is not lost.
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                await self._changed.wait()
        self._changed.clear()

    def journal(self, kind: str, payload: Message) -> None:
        assert self._books.newest is not None
        self._books.newest.append(kind, payload)

    def publish_record(self, record: DecisionRecord) -> None:
        self._bus.tell(self._keys.decisions, record)

    def publish_state(self, state: MissionState) -> None:
        self._bus.tell(self._keys.mission_state, state)

    async def activate(self, request: Activate, action: str) -> Outcome:
        return await ask_until_answered(
            self._bus,
            self._keys.activate(request.skill),
            request,
            Outcome,
            server=self._keys.live("middleware"),
            timeout_s=request.deadline_s + ACTIVATION_MARGIN_S,
        )

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        return await self._shelf.newest(running, past)
