"""The middleware as the solver sees it: which mappings run, and which skills can be run."""

import logging
from collections.abc import Callable
from contextlib import suppress

from aos_protocol.errors import AosError, BusError
from aos_protocol.keys import Keys
from aos_protocol.messages import MappingQuery, MappingState
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.subscription import merged
from aos_runtime.parties.reported_state import state_when

log = logging.getLogger(__name__)

ASK_TIMEOUT_S = 5.0
MAPPING_DEADLINE_S = 20.0


class MappingWatch:
    """Follows what the middleware tells; `on_changed` hears of each change.

    `unavailable` are the skills that nobody could run now, each with the reason, and the adapter of those
    `returning` is expected back. `announced` is how often the
    adapter of each skill has come.
    """

    def __init__(self, bus: Bus, keys: Keys, on_changed: Callable[[], None]) -> None:
        self._bus = bus
        self._keys = keys
        self._on_changed = on_changed
        self._revisions: tuple[int, ...] = ()
        self._stamp_ns = 0
        self.unavailable: dict[str, str] = {}
        self.returning: tuple[str, ...] = ()
        self.announced: dict[str, int] = {}

    def is_mapped(self, revision: int) -> bool:
        """Says whether the middleware runs a revision."""
        return revision in self._revisions

    async def until_dealt_with(self, revision: int) -> None:
        """Waits until the middleware has dealt with a revision. After the deadline activations tell of it."""
        try:
            state = await state_when(
                self._bus,
                self._keys.mapping_state,
                MappingQuery(),
                MappingState,
                lambda state: max(state.revision, state.refused) >= revision,
                timeout_s=MAPPING_DEADLINE_S,
            )
            self._take(state)
        except AosError as error:
            log.warning("the middleware has no mappings of revision %d: %s", revision, error)

    async def follow(self) -> None:
        """Follows what it tells, and asks when it has come: what it told while it was away is lost."""
        told = self._bus.listen(self._keys.mapping_state, MappingState)
        async with merged(told, self._bus.presence(self._keys.live("middleware"))) as events:
            async for _, event in events:
                if isinstance(event, MappingState):
                    self._take(event)
                elif event:
                    with suppress(BusError):
                        self._take(await self._ask())
                else:
                    self._stamp_ns = 0  # The next one may run on a machine that was started again.

    async def _ask(self) -> MappingState:
        return await self._bus.ask(
            self._keys.mapping_state, MappingQuery(), MappingState, timeout_s=ASK_TIMEOUT_S
        )

    def _take(self, state: MappingState) -> None:
        """Takes what is told or answered; an answer may be read after what was told later."""
        if state.stamp_ns < self._stamp_ns:
            return
        self._stamp_ns = state.stamp_ns
        if state.unavailable != self.unavailable:
            why = "; ".join(f"{skill}: {reason}" for skill, reason in state.unavailable.items())
            log.info("unavailable skills: %s", why or "none")
        self.unavailable, self.announced = state.unavailable, state.announced
        self.returning = state.returning
        for revision in state.revisions:
            if revision not in self._revisions:
                log.info("the middleware has revision %d", revision)
        self._revisions = state.revisions
        self._on_changed()
