"""The middleware on the real bus, between a scripted registry and a scripted adapter.

It runs in the test's process, on a connection of its own, or as a process that a test may end.
"""

import asyncio
import logging
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

import msgspec
from mapping_documents import skill_of
from processes import HANG_S
from projects import bundle_project
from starting import until_present

from aos_middleware.service import serve
from aos_middleware.settings import Settings
from aos_protocol import messages
from aos_protocol.documents import Project
from aos_protocol.keys import Keys, Lack, Serving
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.reported_state import state_when
from aos_runtime.processes.children import PIPE, Child
from aos_runtime.processes.lifecycle import serve_on_bus

__all__ = [
    "HANG_S",
    "SENSE",
    "Adapter",
    "Registry",
    "System",
    "answering",
    "hang",
    "running_system",
    "succeed",
]


SENSE = """\
project: armadillo
response: heard
response_rule: level > 3
response: quiet
response_rule: level <= 3
module_activation: skill
path: /sense
max_duration: 0.5
local_variable: level
topic: /level
message_type: Level
initial_value: 0
code:
return __input.data
"""


class Registry:
    """Answers for one project, and announces its revisions."""

    def __init__(self, bus: Bus, keys: Keys, project: Project):
        self._bus = bus
        self._keys = keys
        self.current = messages.ProjectRevision(1, "digest 1", project)

    async def answer(self, query: messages.ProjectQuery, _: str) -> messages.ProjectRevision:
        assert query.project == "armadillo"
        return self.current

    def announce(self, project: Project):
        number = self.current.revision + 1
        self.current = messages.ProjectRevision(number, f"digest {number}", project)
        self._bus.tell(self._keys.announced, self.current)


class Adapter:
    """Answers calls as the test says, and remembers them and its motions."""

    def __init__(self, bus: Bus, keys: Keys):
        self._bus = bus
        self._keys = keys
        self._sent: dict[str, int] = {}
        self.motions: dict[messages.ActivationId, asyncio.Future[dict[str, Any]]] = {}
        self.calls: list[messages.SkillCall] = []
        self.cancelled: list[str] = []
        self.is_called = asyncio.Event()
        self.is_cancelled = asyncio.Event()

    async def serve(
        self,
        path: str,
        answer: Callable[[messages.SkillCall], Awaitable[dict[str, Any]]],
        changed: Callable[[messages.SkillResult], messages.SkillResult] = lambda result: result,
    ):
        async def run(call: messages.SkillCall, _: str) -> messages.SkillResult:
            self.calls.append(call)
            self.is_called.set()
            # One motion for each id: a call that comes again joins it.
            if call.id not in self.motions:
                self.motions[call.id] = asyncio.ensure_future(answer(call))
            fields = await asyncio.shield(self.motions[call.id])
            return changed(messages.SkillResult(call.id, fields, dict(self._sent)))

        await self._bus.answer(self._keys.call(path), messages.SkillCall, run)
        await self.announce(path)

    async def announce(self, path: str, adapter: str = "scripted"):
        """Says that calls of the path are answered."""
        await self._bus.announce(self._token(path, adapter))

    def withdraw(self, path: str, adapter: str = "scripted"):
        self._bus.withdraw(self._token(path, adapter))

    async def lack(self, path: str, reason: str):
        await self._bus.announce(self._keys.lack(Lack("scripted", reason, path)))

    @property
    def instance(self) -> str:
        """The instance in its tokens: that of a program which tells no process."""
        return self._bus.instance

    def _token(self, path: str, adapter: str) -> str:
        return self._keys.serve(Serving(adapter, "1", self.instance, path))

    async def serve_cancel(self, path: str, is_still: asyncio.Event | None = None):

        async def cancel(request: messages.Cancel, _: str) -> messages.Cancelled:
            self.cancelled.append(request.reason)
            self.is_cancelled.set()
            if is_still is not None:
                await is_still.wait()
            return messages.Cancelled()

        await self._bus.answer(self._keys.cancel(path), messages.Cancel, cancel)

    def publish(self, topic: str, fields: dict[str, Any]):
        self._sent[topic] = self._sent.get(topic, 0) + 1
        self._bus.tell(self._keys.topic(topic), messages.TopicMessage(self._sent[topic], fields))


def assert_ended(outcome: messages.Outcome, status: str, code: str, text: str = ""):
    assert outcome.fault is not None
    assert (outcome.status, outcome.fault.code) == (status, code)
    assert text in f"{outcome.fault.message} {outcome.fault.hint}"


class System:
    """A middleware with its surroundings, and how the solver speaks to it."""

    def __init__(self, bus: Bus, keys: Keys, settings: Settings, registry: Registry, adapter: Adapter):
        self.bus = bus
        self.keys = keys
        self.run_dir = Path(settings.run_dir)
        self.registry = registry
        self.adapter = adapter
        self.child: Child | None = None
        self._settings = settings
        self.log = ""
        self._has_logged = asyncio.Event()
        self._running: asyncio.Task[None] | None = None

    async def start(self):
        """Starts the service as a process; returns when it answers."""
        path = self.run_dir / "middleware.json"
        path.write_bytes(msgspec.json.encode(self._settings))
        async with until_present(self.bus, self.keys.live("middleware")):
            self.child = await Child.start([sys.executable, "-m", "aos_middleware", str(path)], stderr=PIPE)
            self._running = asyncio.create_task(self._read_log(self.child))

    async def host(self):
        """Starts the service in this process, which has imported it already; returns when it answers."""
        async with until_present(self.bus, self.keys.live("middleware")):
            self._running = asyncio.create_task(self._serve())

    async def stop(self):
        """Ends the service; raises what it has failed with."""
        if self._running is None:
            return
        if self.child is not None:
            await self.child.stop(5.0)
        else:
            self._running.cancel()
        with suppress(asyncio.CancelledError):
            await self._running

    async def state(self, revision: int) -> messages.MappingState:
        return await self.state_when(lambda state: state.revision >= revision)

    async def refusal(self, revision: int) -> messages.MappingState:
        return await self.state_when(lambda state: state.refused >= revision)

    async def state_when(self, holds: Callable[[messages.MappingState], bool]) -> messages.MappingState:
        return await state_when(
            self.bus,
            self.keys.mapping_state,
            messages.MappingQuery(),
            messages.MappingState,
            holds,
            timeout_s=HANG_S,
        )

    async def can_run(self, skill: str) -> messages.MappingState:
        return await self.state_when(lambda state: skill not in state.unavailable)

    async def cannot_run(self, skill: str) -> messages.MappingState:
        return await self.state_when(lambda state: skill in state.unavailable)

    async def activate(
        self,
        skill: str,
        step: int = 1,
        parameters: dict[str, Any] | None = None,
        deadline_s: float = 10.0,
        revision: int = 0,
    ) -> messages.Outcome:
        request = messages.Activate(
            messages.ActivationId("m", step), skill, parameters or {}, deadline_s, revision=revision
        )
        return await self.bus.ask(self.keys.activate(skill), request, messages.Outcome, timeout_s=HANG_S)

    async def beside_a_motion(
        self, skill: str, deadline_s: float = 10.0
    ) -> tuple[asyncio.Task[messages.Outcome], asyncio.Event]:
        """Activates a skill while another may still be moving; also gives what lets that stand still."""
        is_still = asyncio.Event()
        await self.adapter.serve(
            "/sense", lambda call: hang(call) if call.id.step == 1 else answering({})(call)
        )
        await self.adapter.serve_cancel("/sense", is_still)
        assert (await self.activate("sense", 1)).status == "timed_out"
        self.adapter.is_cancelled.clear()
        waiting = asyncio.create_task(self.activate(skill, 2, deadline_s=deadline_s))
        await asyncio.wait_for(self.adapter.is_cancelled.wait(), HANG_S)
        return waiting, is_still

    async def logged(self, text: str, times: int = 1) -> str:
        async with asyncio.timeout(HANG_S):
            while self.log.count(text) < times:
                self._has_logged.clear()
                await self._has_logged.wait()
            return self.log

    def _note(self, text: str):
        self.log += text
        self._has_logged.set()

    async def _read_log(self, child: Child):
        while line := await child.stderr.readline():
            self._note(line.decode())

    async def _serve(self):
        log = logging.getLogger("aos")
        handler = _Lines(self._note)
        log.addHandler(handler)
        log.setLevel(logging.INFO)
        try:
            await serve_on_bus(self._settings, serve)
        finally:
            log.setLevel(logging.NOTSET)
            log.removeHandler(handler)


class _Lines(logging.Handler):
    """Hands over each line of a log."""

    def __init__(self, note: Callable[[str], None]):
        super().__init__()
        self._note = note

    def emit(self, record: logging.LogRecord):
        self._note(f"{record.getMessage()}\n")


@asynccontextmanager
async def running_system(
    bus: Bus,
    other: Bus,
    keys: Keys,
    run_dir: Path,
    endpoint: str,
    bundle: Path,
    *,
    is_process: bool = False,
    **settings: Any,
) -> AsyncIterator[System]:
    project = bundle_project(bundle)
    sense = skill_of(SENSE, "sense.am")
    project = msgspec.structs.replace(project, skills=(*project.skills, sense))
    registry = Registry(other, keys, project)
    await other.answer(keys.project, messages.ProjectQuery, registry.answer)
    await other.announce(keys.live("registry"))
    values = Settings(
        robot=keys.robot,
        service="middleware",
        endpoint=endpoint,
        run_dir=str(run_dir),
        project="armadillo",
        **settings,
    )
    system = System(bus, keys, values, registry, Adapter(other, keys))
    try:
        await (system.start() if is_process else system.host())
        await system.state(1)
        yield system
    finally:
        await system.stop()


def answering(fields: dict[str, Any]) -> Callable[[messages.SkillCall], Awaitable[dict[str, Any]]]:
    async def answer(_: messages.SkillCall) -> dict[str, Any]:
        return fields

    return answer


succeed = answering({"success": True})


async def hang(_: messages.SkillCall) -> dict[str, Any]:
    await asyncio.Event().wait()
    return {}
