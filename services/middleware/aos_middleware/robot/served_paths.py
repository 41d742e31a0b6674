"""The paths that can be called: liveliness tokens say who answers them."""

import asyncio
import logging
from collections import Counter
from collections.abc import Callable

from aos_protocol.errors import SkillError
from aos_protocol.keys import Keys, Lack, Serving
from aos_protocol.unavailable import NO_ADAPTER
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.subscription import merged

_log = logging.getLogger("aos.middleware")


class ServedPaths:
    """The adapters that serve each path now; `follow` keeps them up to date, and `on_change` is called
    after each change.

    An adapter that is started again announces one path after the other, and then that it is ready. A decision
    between two of them would do without skills that are there a moment later, so that nobody decides for any
    of them before. Programs in other languages announce their paths alone.
    """

    def __init__(self, bus: Bus, keys: Keys, on_change: Callable[[], None]) -> None:
        self._bus = bus
        self._keys = keys
        self._on_change = on_change
        self._changed = asyncio.Event()
        self._servers: dict[str, list[Serving]] = {}
        self._lacks: dict[str, dict[str, Lack]] = {}
        self._announced: Counter[str] = Counter()
        self._last: dict[str, str] = {}
        self._returning: set[str] = set()
        self._is_ready: dict[str, bool] = {}
        self._has_heard = asyncio.Event()

    async def follow(self) -> None:
        """Follows the tokens until the bus closes."""
        all_keys = (self._keys.all_serve, self._keys.all_live, self._keys.all_lacks, self._keys.all_returning)
        async with merged(*(self._bus.presence(keys) for keys in all_keys)) as changes:
            if not changes.has_items:
                self._tell()
            async for key, is_alive in changes:
                if serving := self._keys.serving_of(key):
                    self._take_in(serving, is_alive)
                elif lack := self._keys.lack_of(key):
                    self._take_lack(lack, is_alive)
                elif adapter := self._keys.returning_of(key):
                    (self._returning.add if is_alive else self._returning.discard)(adapter)
                else:
                    self._is_ready[self._keys.service_of(key)] = is_alive
                self._changed.set()
                if not changes.has_items:
                    self._tell()

    def _tell(self) -> None:
        """All that is known of now was heard."""
        self._has_heard.set()
        self._on_change()

    def _take_in(self, serving: Serving, is_alive: bool) -> None:
        servers = self._servers.setdefault(serving.path, [])
        servers.append(serving) if is_alive else servers.remove(serving)
        self._announced[serving.path] += is_alive
        self._last[serving.path] = serving.adapter
        _log.info("%s %s %s", serving.adapter, "serves" if is_alive else "has left", serving.path)

    def _take_lack(self, lack: Lack, is_alive: bool) -> None:
        told = self._lacks.setdefault(lack.path, {})
        if is_alive:
            told[lack.adapter] = lack
        elif told.get(lack.adapter) == lack:
            del told[lack.adapter]

    @property
    def has_heard(self) -> bool:
        """Says whether everybody who was there before is known."""
        return self._has_heard.is_set()

    async def until_heard(self) -> None:
        """Returns once everybody who was there before is known."""
        await self._has_heard.wait()

    def servers(self, path: str) -> list[Serving]:
        """Returns the adapters that answer calls of a path now."""
        return self._servers.get("/" + path.strip("/"), [])

    def announced(self, path: str) -> int:
        """Returns how often somebody has announced to serve a path."""
        return self._announced["/" + path.strip("/")]

    def fault(self, path: str) -> SkillError | None:
        """Returns why a path cannot be called now: AOS505 if nobody serves it, AOS511 if two do."""
        servers = self.servers(path)
        if not servers:
            told = [f"{lack.adapter} says: {lack.reason}" for lack in self._lacking(path)]
            if adapter := self.returning(path):
                told.append(f"{adapter} is expected back")
            return no_adapter(path, "; ".join(told))
        if len(servers) > 1:
            names = " and ".join(server.who for server in servers)
            hint = "End one of them, or bind it to another path"
            return SkillError(f"{path} is served by {names}", code="AOS511", hint=hint)
        return None

    def is_for_good(self, path: str) -> bool:
        """Returns whether nobody serves a path, and an adapter says that to wait does not mend it."""
        return not self.servers(path) and any(lack.is_for_good for lack in self._lacking(path))

    def returning(self, path: str) -> str:
        """Returns the adapter that served a path and is expected back; empty where somebody serves it."""
        adapter = "" if self.servers(path) else self._last.get("/" + path.strip("/"), "")
        return adapter if adapter in self._returning else ""

    def _lacking(self, path: str) -> list[Lack]:
        return sorted(self._lacks.get("/" + path.strip("/"), {}).values())

    def why_unavailable(self, path: str) -> str:
        """Returns why nobody should decide for a skill of this path now; empty where somebody may."""
        servers = self.servers(path)
        if fault := self.fault(path):
            return f"{fault.message}. {fault.hint}" if servers else fault.message
        (server,) = servers
        is_ready = self._is_ready.get(server.adapter, True)
        return "" if is_ready else f"{path} is served by {server.adapter}, which is still starting"

    async def has_left(self, path: str, within_s: float) -> bool:
        """Waits until nobody serves a path, at most for a short time; returns whether that is so."""
        return await self._comes_to(path, False, within_s)

    async def is_back(self, path: str, within_s: float) -> bool:
        """Says whether somebody serves a path, now or within some time."""
        return await self._comes_to(path, True, within_s)

    async def _comes_to(self, path: str, is_served: bool, within_s: float) -> bool:
        try:
            async with asyncio.timeout(within_s):
                while bool(self.servers(path)) is not is_served:
                    self._changed.clear()
                    await self._changed.wait()
        except TimeoutError:
            return False
        return True


def no_adapter(path: str, lacks: str = "") -> SkillError:
    """Nothing was begun. Adapters that are there may have told what they lack."""
    if lacks:
        return SkillError(f"{NO_ADAPTER}{path}: {lacks}", code="AOS505", hint="See the adapter's log")
    hint = f"Name one for {path} under `bind:` in the deploy file, and see that it runs"
    return SkillError(f"{NO_ADAPTER}{path}", code="AOS505", hint=hint)
