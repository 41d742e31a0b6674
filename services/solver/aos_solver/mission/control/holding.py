"""The holds of a mission: for skills that cannot be run, after a failure, and by whoever steers it."""

from collections.abc import Awaitable, Callable

from aos_protocol.errors import AosError
from aos_solver.mission.control.helm import Helm
from aos_solver.mission.ports import Ports
from aos_solver.mission.rules.failures import Failures

_LOOKS_AGAIN_S = 60.0
"""A mission that waits for somebody looks again after this time, whatever was told."""


class Holding:
    """Holds a mission, for `hold_s` at most where nobody steers it; `adopt` is how a model takes over."""

    def __init__(
        self,
        hold_s: float,
        ports: Ports,
        helm: Helm,
        failures: Failures,
        adopt: Callable[[], Awaitable[bool]],
    ) -> None:
        self._hold_s = hold_s
        self._ports = ports
        self._helm = helm
        self._failures = failures
        self._adopt = adopt
        self._is_resumed = False

    def resume(self) -> None:
        """Somebody has looked after what the mission holds for."""
        self._is_resumed = True

    async def for_operator(self) -> None:
        """Waits while somebody holds the mission, however long. Newer models take over meanwhile."""
        while True:
            await self._adopt()
            if self._helm.now.to_stop or not self._helm.now.waits:
                return
            await self._ports.until_changed(_LOOKS_AGAIN_S)

    async def until(self, why: str, goes_on: Callable[[], bool], *, adopts: bool = False) -> None:
        """Waits until the mission goes on by itself, is resumed or stopped; AosError AOS513 after `hold_s`.

        Where it `adopts`, it also goes on with a model that takes over.
        """
        ends_at_s = self._ports.clock.monotonic_s() + self._hold_s
        self._is_resumed = False
        while not (self._is_resumed or self._helm.now.to_stop or goes_on()):
            now_s = self._ports.clock.monotonic_s()
            left_s = _LOOKS_AGAIN_S if self._is_steered else ends_at_s - now_s
            if adopts and await self._adopt():
                return
            if left_s <= 0:
                raise AosError(f"{why}; nothing has changed for {self._hold_s:g} s", code="AOS513")
            await self._ports.until_changed(min(left_s, self._failures.s_until_return(now_s)))

    @property
    def _is_steered(self) -> bool:
        return bool(self._helm.now.held_by or self._helm.now.left_out)
