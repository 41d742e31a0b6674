"""The middleware service: wires documents, mappings, activations and the bus.

Ready as soon as it can be asked; the project comes from the registry when that is there, and again with each
announcement. One activation at a time runs for each skill.
"""

import asyncio
import logging
from pathlib import Path

from msgspec.structs import replace

from aos_middleware.activations.activation import refused, run_activation
from aos_middleware.activations.surroundings import OutcomeLedger, Surroundings
from aos_middleware.emission.emit import EmittedMapping
from aos_middleware.mappings.low_level import LowLevelValues
from aos_middleware.mappings.monitors import Monitors
from aos_middleware.mappings.revisions import Mappings
from aos_middleware.robot.motion_gate import MotionGate
from aos_middleware.robot.odd_data import OddNumbers, SilentTopics
from aos_middleware.robot.served_paths import ServedPaths
from aos_middleware.settings import Settings
from aos_middleware.workers.evaluator import EvaluationLimits, Evaluator
from aos_protocol.errors import BusError, SkillError
from aos_protocol.messages import Activate, ActivationId, MappingQuery, MappingState, Outcome, ProjectRevision
from aos_runtime.parties.fence import Fence, epoch_of_solver
from aos_runtime.parties.registry_watch import RegistryWatch
from aos_runtime.processes.lifecycle import Service

FIRST_MAPPINGS_S = 20.0
"""An activation waits this long for the first mappings of a middleware that was started again."""

_log = logging.getLogger("aos.middleware")


async def serve(service: Service[Settings]) -> None:
    """Answers activations until it is stopped."""
    middleware = _Middleware(service)
    try:
        await middleware.run()
    finally:
        await middleware.close()


class _Middleware:
    """The answers of the service, and what it remembers between them."""

    def __init__(self, service: Service[Settings]) -> None:
        settings = service.settings
        run_dir = Path(settings.run_dir)
        folder = Path(settings.generated_dir) if settings.generated_dir else run_dir / "generated" / "python"
        self._service = service
        self._settings = settings
        self._logs = run_dir / "logs"
        self._limits = EvaluationLimits(
            load_s=settings.load_s,
            evaluation_s=settings.evaluation_s,
            allowed_imports=settings.allowed_imports,
        )
        self._mappings = Mappings(folder, self._make_evaluator, self._take_over)
        self._served = ServedPaths(service.bus, service.keys, self._tell_state)
        self._ledger = OutcomeLedger(run_dir / "middleware.db")
        self._fence = Fence(epoch_of_solver(service.bus, service.keys))
        for request in self._ledger.requests():
            self._fence.note(request)
        self._low_level = LowLevelValues(self._ledger.outcomes())
        self._monitors = Monitors(service.bus, service.keys)
        self._around = Surroundings(
            bus=service.bus,
            keys=service.keys,
            clock=service.clock,
            published={},
            low_level=self._low_level,
            served=self._served,
            gate=MotionGate(service.bus, service.keys, self._served, self._tell_state),
            on_stray=self._ledger.note,
            is_played=settings.is_played,
            monitors=self._monitors,
            silent=SilentTopics(),
            odd=OddNumbers(),
        )
        self._running: dict[ActivationId, asyncio.Event] = {}
        self._running_skills: dict[str, ActivationId] = {}
        self._stamp_ns = 0

    async def run(self) -> None:
        bus, keys = self._service.bus, self._service.keys
        registry = RegistryWatch(bus, keys, self._settings.project, self._mappings.adopt)
        async with bus.listen(keys.announced, ProjectRevision) as announced, asyncio.TaskGroup() as tasks:
            await bus.answer(keys.activate_any, Activate, self._activate)
            await bus.answer(keys.mapping_state, MappingQuery, self._answer_state)
            await self._service.ready()
            tasks.create_task(self._served.follow())
            tasks.create_task(self._around.gate.follow())
            tasks.create_task(self._monitors.run())
            tasks.create_task(registry.follow())
            async for _, revision in announced:
                if revision.project.name == self._settings.project:
                    tasks.create_task(self._mappings.adopt(revision))

    async def close(self) -> None:
        # The ledger first: what an activation makes of its vanishing worker is no outcome to remember.
        self._ledger.close()
        await self._mappings.close()

    def _make_evaluator(self, emitted: EmittedMapping) -> Evaluator:
        return Evaluator(emitted, self._logs / f"mapping-{emitted.skill}.log", self._limits)

    async def _answer_state(self, _: MappingQuery, __: str) -> MappingState:
        await self._served.until_heard()
        return self._state()

    def _state(self) -> MappingState:
        """The mappings that run, which of their skills nobody could run, and how often adapters came."""
        shut, paths = self._around.gate.shut, self._mappings.paths
        why = {skill: self._served.why_unavailable(path) or shut for skill, path in paths.items()}
        unavailable = {skill: reason for skill, reason in why.items() if reason}
        for_good = tuple(skill for skill, path in paths.items() if self._served.is_for_good(path))
        returning = tuple(skill for skill, path in paths.items() if self._served.returning(path))
        announced = {skill: self._served.announced(path) for skill, path in paths.items()}
        self._stamp_ns = max(self._stamp_ns + 1, round(self._service.clock.monotonic_s() * 1e9))
        return replace(
            self._mappings.state,
            unavailable=unavailable,
            for_good=for_good,
            returning=returning,
            announced=announced,
            stamp_ns=self._stamp_ns,
        )

    def _take_over(self) -> None:
        """Other mappings are in use."""
        self._monitors.follow(self._mappings.monitors)
        self._tell_state()

    def _tell_state(self) -> None:
        """Tells the state, unless adapters that are there may not be known yet: they are none that left."""
        if self._served.has_heard:
            self._service.bus.tell(self._service.keys.mapping_state, self._state())

    async def _activate(self, request: Activate, key: str) -> Outcome:
        """Runs an activation, joins the one of the same id, or tells again how it ended."""
        if key != self._service.keys.activate(request.skill):
            raise BusError(f"an activation of {request.skill} was sent to {key}", code="AOS602")
        try:
            await self._fence.check(request)
        except SkillError as error:
            _log.warning("%s", error)
            return refused(request, error, self._service.clock.now_ns())
        if request.id in self._running:
            await self._running[request.id].wait()
        known = self._ledger.outcome(request.id)
        if known is not None:
            return known
        await self._mappings.until_first(FIRST_MAPPINGS_S)
        await self._served.until_heard()
        evaluator = self._mappings.evaluator(request.skill, request.revision)
        if request.skill in self._running_skills:
            raise SkillError(
                f"{request.skill} is running already, for activation {self._running_skills[request.skill]}",
                hint="Wait for its outcome, or cancel it",
            )
        if request.deadline_s <= 0:
            request = replace(request, deadline_s=self._settings.activation_timeout_s)
        return await self._run(request, evaluator)

    async def _run(self, request: Activate, evaluator: Evaluator) -> Outcome:
        ended = self._running[request.id] = asyncio.Event()
        self._running_skills[request.skill] = request.id
        try:
            async with evaluator.in_use:
                is_taken_up = self._ledger.was_started(request.id)
                self._ledger.start(request)
                self._fence.note(request)
                outcome = await run_activation(request, evaluator, self._around, is_taken_up=is_taken_up)
                self._ledger.end(outcome)
                self._low_level.take(outcome)
        finally:
            del self._running[request.id], self._running_skills[request.skill]
            ended.set()
        _log.info("%s %s: %s", request.id, request.skill, outcome.response or _why(outcome))
        return outcome


def _why(outcome: Outcome) -> str:
    return f"{outcome.status}, {outcome.fault.message}" if outcome.fault else outcome.status
