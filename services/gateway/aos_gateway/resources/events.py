"""The event stream of a page: server-sent events of one mission's system, and of the list of runs.

The id of an event is `<mission>:<n>`, where the next decision record is number n. A browser that has lost
the connection sends it as `Last-Event-ID`, and gets what it missed from the journal. The server keeps
nothing for it, so that this also holds for a gateway that was started again.
"""

import asyncio
from collections.abc import AsyncIterator

import msgspec

from aos_gateway.runs.feed import Frame, Watches, frame_of_record, frame_of_state
from aos_gateway.runs.run import Run
from aos_gateway.runs.shelf import RunShelf
from aos_gateway.runs.trace import Steps

_BEAT_S = 10.0
_LIST_S = 1.0
_LISTED = 50
_MOST_DIGITS = 16


def place_of(event_id: str) -> tuple[str, int]:
    """The mission and the next sequence number in an event's id; nothing and 0 in any other text."""
    mission, _, number = event_id.rpartition(":")
    is_number = number.isascii() and number.isdigit() and len(number) <= _MOST_DIGITS
    return (mission, int(number)) if mission and is_number else ("", 0)


async def stream(
    shelf: RunShelf, watches: Watches, run: Run | None, mission: str, since: int
) -> AsyncIterator[bytes]:
    """Yields the events: of the mission from record `since` on, what its system tells, and changes of the
    list."""
    yield b"retry: 1000\n\n"
    if run is None:
        async for frame in _list(shelf):
            yield _encoded(frame, mission, since)
        return
    with watches.viewer(run) as viewer:
        async for frame in _past(run, mission, since):
            since = max(since, frame.sequence + 1)
            yield _encoded(frame, mission, since)
        if (end := await _end(run, mission)) is not None:
            yield _encoded(end, mission, since)
        listing = _list(shelf)
        upcoming: dict[asyncio.Task[Frame], bool] = {}
        try:
            while not viewer.is_lost:
                _renew(upcoming, viewer.queue, listing)
                done, _ = await asyncio.wait(upcoming, timeout=_BEAT_S, return_when=asyncio.FIRST_COMPLETED)
                if not done:
                    yield b": \n\n"
                for task in done:
                    del upcoming[task]
                    frame = task.result()
                    if frame.is_after_gap or (frame.mission == mission and frame.sequence > since):
                        # Something is missing, or may be: the journal has it, and this one as well.
                        async for missed in _past(run, mission, since):
                            since = missed.sequence + 1
                            yield _encoded(missed, mission, since)
                    if end is not None and frame.kind == "state" and frame.mission == mission:
                        continue  # The watch of a system that has just ended may have an older one.
                    if frame.sequence == -1 or (frame.mission == mission and frame.sequence >= since):
                        since = max(since, frame.sequence + 1)
                        yield _encoded(frame, mission, since)
        finally:
            for task in upcoming:
                task.cancel()


def _renew(
    upcoming: dict[asyncio.Task[Frame], bool], queue: asyncio.Queue[Frame], listing: AsyncIterator[Frame]
) -> None:
    """Awaits one frame of each source."""
    if True not in upcoming.values():
        upcoming[asyncio.ensure_future(queue.get())] = True
    if False not in upcoming.values():
        upcoming[asyncio.ensure_future(_following(listing))] = False


async def _following(listing: AsyncIterator[Frame]) -> Frame:
    return await anext(listing)


async def _past(run: Run, mission: str, since: int) -> AsyncIterator[Frame]:
    rows = Steps(whole=True)
    has_more = True
    while has_more:
        page = await run.page(mission, since)
        for record in page.records:
            yield frame_of_record(record, rows)
            since = record.sequence + 1
            # Others have their turn, and a client that has left is noticed before all is written to nobody.
            await asyncio.sleep(0)
        has_more = page.has_more


async def _end(run: Run, mission: str) -> Frame | None:
    """The state of a mission that is over, which nobody on a bus tells any more."""
    state = await run.last_state(mission)
    return frame_of_state(state) if state is not None and state.phase == "ended" else None


async def _list(shelf: RunShelf) -> AsyncIterator[Frame]:
    """Yields the list of runs whenever it is another one than before; the first time at the first change."""
    known: bytes | None = None
    while True:
        data = msgspec.json.encode((await shelf.entries())[:_LISTED])
        if data != known:
            if known is not None:
                yield Frame("runs", data)
            known = data
        await asyncio.sleep(_LIST_S)


def _encoded(frame: Frame, mission: str, next_sequence: int) -> bytes:
    place = f"id: {mission}:{next_sequence}\n" if mission else ""
    return f"{place}event: {frame.kind}\ndata: ".encode() + frame.data + b"\n\n"
