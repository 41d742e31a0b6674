"""The events of a living system, for any number of viewers: one client of the bus, each event encoded
once.

A viewer has a queue of bounded length. One that does not keep up is let go: it comes back with the number
of the last event that it has got, and the journal has what it missed.
"""

import asyncio
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

import msgspec

from aos_gateway.runs.run import Run
from aos_gateway.runs.trace import Step, Steps
from aos_protocol.errors import AosError
from aos_protocol.messages import BundleReport, DecisionRecord, MissionState, SkillProgress
from aos_runtime.bus.subscription import merged

_QUEUE_FRAMES = 2000
_LINGER_S = 5.0
"""A system goes on being watched for this time after its last viewer has left: pages are loaded anew."""
_AGAIN_S = 0.5
_LOOK_S = 1.0

_log = logging.getLogger("aos.gateway")


class Frame(NamedTuple):
    """An event, encoded. `sequence` is that of a decision record, else -1.

    `is_after_gap`: only from here on the system is heard, and the history has what it told before.
    """

    kind: str
    data: bytes
    mission: str = ""
    sequence: int = -1
    is_after_gap: bool = False


class StepEvent(msgspec.Struct, frozen=True):
    """A decision record, and the row of its step with the whole belief."""

    record: DecisionRecord
    row: Step


class Presence(msgspec.Struct, frozen=True):
    """A service has come to the bus or has left it."""

    service: str
    is_there: bool


class Viewer:
    """The queue of one stream. `is_lost` says that it was too slow."""

    def __init__(self) -> None:
        self.queue: asyncio.Queue[Frame] = asyncio.Queue(_QUEUE_FRAMES)
        self.is_lost = False

    def push(self, frame: Frame) -> None:
        """Puts an event into the queue, unless it is full."""
        try:
            self.queue.put_nowait(frame)
        except asyncio.QueueFull:
            self.is_lost = True


class Watch:
    """A living system, watched as long as somebody views it."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._viewers: set[Viewer] = set()
        self._present: set[str] = set()
        self._state: MissionState | None = None
        self._rows = Steps(whole=True)
        self.has_viewers = asyncio.Event()

    def add(self, viewer: Viewer) -> None:
        """Lets a viewer hear what comes, and first what holds now."""
        for service in sorted(self._present):
            viewer.push(_frame_of_presence(service, is_there=True))
        if self._state is not None:
            viewer.push(frame_of_state(self._state))
        self._viewers.add(viewer)
        self.has_viewers.set()

    def remove(self, viewer: Viewer) -> None:
        """Lets it hear no more."""
        self._viewers.discard(viewer)
        if not self._viewers:
            self.has_viewers.clear()

    async def run(self) -> None:
        """Watches until nobody has viewed for a while, or the system is over."""
        watching = asyncio.ensure_future(self._follow())
        try:
            while not watching.done() and not await self._is_left():
                await asyncio.wait({watching}, timeout=_LINGER_S)
        finally:
            watching.cancel()
            await asyncio.gather(watching, return_exceptions=True)

    async def _is_left(self) -> bool:
        """Says whether nobody views, and nobody comes for a while."""
        try:
            async with asyncio.timeout(_LINGER_S):
                await self.has_viewers.wait()
        except TimeoutError:
            return True
        return False

    async def _follow(self) -> None:
        while self._run.is_running:
            try:
                await self._follow_once()
            except AosError as error:
                _log.info("%s: %s", self._run.name, error)
            self._present.clear()
            await asyncio.sleep(_AGAIN_S)

    async def _follow_once(self) -> None:
        async with self._run.client() as client:
            keys, bus = client.keys, client.bus
            stream = merged(
                bus.listen(keys.decisions, DecisionRecord),
                bus.listen(keys.mission_state, MissionState),
                bus.listen(keys.bundle_report, BundleReport),
                bus.listen(keys.all_progress, SkillProgress),
                bus.presence(keys.all_live),
            )
            async with stream, asyncio.TaskGroup() as tasks:
                tasks.create_task(self._until_over(stream.close))
                async for key, event in stream:
                    if isinstance(event, bool):
                        self._take_presence(keys.service_of(key), is_there=event)
                        if event and keys.service_of(key) == "solver":
                            self._take(await client.mission_state())
                    else:
                        self._take(event)

    async def _until_over(self, close: Callable[[], None]) -> None:
        """Ends the stream when the run is over: a bus whose router has gone says nothing."""
        is_running = True
        while is_running:
            await asyncio.sleep(_LOOK_S)
            is_running = await asyncio.to_thread(lambda: self._run.is_running)
        close()

    def _take_presence(self, service: str, *, is_there: bool) -> None:
        (self._present.add if is_there else self._present.discard)(service)
        self._tell(_frame_of_presence(service, is_there=is_there))

    def _take(self, event: DecisionRecord | MissionState | BundleReport | SkillProgress) -> None:
        if isinstance(event, DecisionRecord):
            self._tell(frame_of_record(event, self._rows))
        elif isinstance(event, MissionState):
            self._state = event
            self._tell(frame_of_state(event))
        elif isinstance(event, BundleReport):
            self._tell(Frame("bundle", msgspec.json.encode(event)))
        else:
            self._tell(Frame("progress", msgspec.json.encode(event)))

    def _tell(self, frame: Frame) -> None:
        for viewer in self._viewers:
            viewer.push(frame)


class Watches:
    """The systems that are watched now, by run."""

    def __init__(self, tasks: asyncio.TaskGroup) -> None:
        self._tasks = tasks
        self._watches: dict[str, Watch] = {}
        self._running: set[asyncio.Task[None]] = set()

    def close(self) -> None:
        """Ends all of them."""
        for task in self._running:
            task.cancel()

    @contextmanager
    def viewer(self, run: Run) -> Iterator[Viewer]:
        """A viewer of a system, for the length of the block. Of a run that is over it hears nothing."""
        viewer = Viewer()
        watch = self._watches.get(run.name)
        if watch is None and run.is_running:
            watch = self._watches[run.name] = Watch(run)
            task = self._tasks.create_task(self._watch(run.name, watch))
            self._running.add(task)
            task.add_done_callback(self._running.discard)
        if watch is not None:
            watch.add(viewer)
        try:
            yield viewer
        finally:
            if watch is not None:
                watch.remove(viewer)

    async def _watch(self, name: str, watch: Watch) -> None:
        try:
            await watch.run()
        except Exception:
            _log.exception("%s is not watched any more", name)
        finally:
            del self._watches[name]


def frame_of_record(record: DecisionRecord, rows: Steps) -> Frame:
    """The event of a decision, or of its outcome."""
    event = StepEvent(record, rows.take(record))
    return Frame("decision", msgspec.json.encode(event), record.mission, record.sequence)


def frame_of_state(state: MissionState) -> Frame:
    """The event of a mission's state."""
    return Frame("state", msgspec.json.encode(state), state.mission)


def _frame_of_presence(service: str, *, is_there: bool) -> Frame:
    data = msgspec.json.encode(Presence(service, is_there))
    return Frame("service", data, is_after_gap=is_there and service == "solver")
