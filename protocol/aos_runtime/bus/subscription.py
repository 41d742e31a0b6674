"""A stream from the bus as an asynchronous iterator with a bounded queue.

Messages come from Zenoh's threads to the event loop some at a time, so that a flood of them leaves time for
everything else.
"""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from typing import Self


T = TypeVar("T")

Undeclare = Callable[[], None]


class Subscription(Generic[T]):
    """`async with subscription as items: async for item in items`.

    Once entered, whatever is sent afterwards arrives, in the order of each sender. The oldest item gives way
    when the queue is full; `dropped` counts those. The iteration ends when the subscription is closed, after
    the items already queued.
    """

    def __init__(self, declare: Callable[[Subscription[T]], Awaitable[Undeclare]], queue_size: int) -> None:
        """`declare` starts a stream into `push` of the subscription it gets, and returns what ends it."""
        self.dropped = 0
        self._declare = declare
        self._undeclare: Undeclare | None = None
        self._items: deque[T] = deque(maxlen=queue_size)
        self._changed = asyncio.Event()
        self._is_closed = False

    async def __aenter__(self) -> Self:
        self._undeclare = await self._declare(self)
        return self

    async def __aexit__(self, *_: object) -> None:
        self.close()

    @property
    def has_items(self) -> bool:
        """True where the next item is there already."""
        return bool(self._items)

    def close(self) -> None:
        """Ends the stream; closing twice does nothing."""
        self._is_closed = True
        self._changed.set()
        if self._undeclare is not None:
            self._undeclare()
            self._undeclare = None

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> T:
        while not self._items:
            if self._is_closed:
                raise StopAsyncIteration
            self._changed.clear()
            await self._changed.wait()
        return self._items.popleft()

    async def batches(self) -> AsyncIterator[list[T]]:
        """The items that are there together, 256 at most."""
        async for first in self:
            batch = [first]
            while self._items and len(batch) < 256:
                batch.append(self._items.popleft())
            yield batch

    def push(self, item: T) -> None:
        """Puts an item into the queue; for the source of the stream."""
        if self._is_closed:
            return
        if len(self._items) == self._items.maxlen:
            self.dropped += 1
        self._items.append(item)
        self._changed.set()


def merged(*subscriptions: Subscription[Any], queue_size: int = 1000) -> Subscription[Any]:
    """One stream out of several that have not been entered; what one sender sends stays in order."""

    async def declare(into: Subscription[Any]) -> Undeclare:
        undeclare = await asyncio.gather(*(one._declare(into) for one in subscriptions))

        def undeclare_all() -> None:
            for end in undeclare:
                end()

        return undeclare_all

    return Subscription(declare, queue_size)


@asynccontextmanager
async def together(*subscriptions: Subscription[Any]) -> AsyncIterator[None]:
    """Enters several subscriptions before anything that the block declares, and closes them with it.

    The block does not wait until the router has taken them in, which takes a round trip: the router takes
    what one session declares in its order.
    """
    entering = asyncio.gather(*(one.__aenter__() for one in subscriptions))
    try:
        await asyncio.sleep(0)  # Now they are declared.
        yield
        await entering
    finally:
        entering.cancel()
        await asyncio.gather(entering, return_exceptions=True)
        for one in subscriptions:
            one.close()


_TURN = 20
"""So many messages are taken before the loop looks after the rest."""


class Inbox:
    """Runs what is put into it on the loop, in this order."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._waiting: deque[Callable[[], None]] = deque()
        self._lock = threading.Lock()
        self._is_awake = False

    def put(self, take: Callable[[], None]) -> None:
        """Takes a call from any thread."""
        with self._lock:
            self._waiting.append(take)
            if self._is_awake:
                return
            self._is_awake = True
        self._loop.call_soon_threadsafe(self._take_some)

    def _take_some(self) -> None:
        for _ in range(_TURN):
            with self._lock:
                if not self._waiting:
                    self._is_awake = False
                    return
                take = self._waiting.popleft()
            take()
        self._loop.call_soon(self._take_some)
