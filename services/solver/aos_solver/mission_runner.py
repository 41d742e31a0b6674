"""The missions of a solver, one or one after the other: how each begins or is taken up, and runs."""

import asyncio
import contextlib
import logging
from collections.abc import Coroutine
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from aos_protocol.errors import AosError, MissionRunsError, SteeringError
from aos_protocol.messages import DriftTests, MissionBegun, MissionState, StartMission
from aos_protocol.mission_rows import BEGUN
from aos_runtime.parties.registry_watch import RegistryWatch
from aos_solver.bus_ports import BusPorts
from aos_solver.child.search import Search
from aos_solver.earlier_models import earlier_models
from aos_solver.mapping_watch import MAPPING_DEADLINE_S, MappingWatch
from aos_solver.mission.abandoning import Abandoning
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import Earlier, RunningModel
from aos_solver.mission.records.logbook import Logbook, Logbooks
from aos_solver.mission.records.memory import MissionMemory
from aos_solver.mission.rules.endings import Ending, MissionLimits
from aos_solver.mission.rules.failures import FailureRules
from aos_solver.mission.rules.terms import Terms
from aos_solver.mission.succession import Succession
from aos_solver.offline.policy import following
from aos_solver.settings import Settings

log = logging.getLogger(__name__)

T = TypeVar("T")


class MissionRunner:
    """Runs missions. `mission` is the newest that has begun in this process; `ended` is set at its end."""

    def __init__(
        self,
        settings: Settings,
        books: Logbooks,
        shelf: ModelShelf,
        mappings: MappingWatch,
        registry: RegistryWatch,
        ports: BusPorts,
    ) -> None:
        self.mission: Mission | None = None
        self.ended = asyncio.Event()
        self.compiling = ""
        """The compiler's work for the first mission, for people; empty where there is none."""
        self._settings = settings
        self._books = books
        self._shelf = shelf
        self._mappings = mappings
        self._registry = registry
        self._ports = ports
        self._starting = asyncio.Lock()
        self._waiting = Abandoning()
        self._unwanted = ""
        self._started = asyncio.Event()
        self._has_begun = asyncio.Event()
        self._succession = Succession(
            books, self._terms, registry.documents, Path(settings.cache_dir), settings.mission_values
        )

    @property
    def is_interrupted(self) -> bool:
        """True where the newest mission had begun when its solver ended, and has not ended."""
        book = self._books.newest
        return book is not None and book.memory.epoch > 0 and not book.memory.has_ended

    @property
    def state(self) -> MissionState:
        """The state of the newest mission, or of the first one to come."""
        if self.mission is not None:
            return self.mission.state
        book = self._books.newest
        if book is not None and book.memory.has_ended and book.memory.state is not None:
            return book.memory.state
        phase = "compiling" if self.compiling and not self._unwanted else "waiting"
        return MissionState(self._books.name, phase, 0, 0.0, remark=self._unwanted or self.compiling)

    async def start(self, start: StartMission) -> None:
        """Starts a mission once its model runs; AosError that says why if it cannot."""
        if start.request and start.request == self._books.last_request:
            return  # It is asked for again.
        if (self._runs or self._starting.locked()) and (start.request or self._settings.stay):
            raise self._busy()
        async with self._starting:
            self._want(start)
            if self._settings.stay:
                await self._begin_next(start)
            elif start.request:
                hint = "Start the system with `aos-up --stay`"
                raise MissionRunsError(f"the system of {self._books.name} has one mission", hint=hint)
            elif self.mission is None and not self._has_ended:
                with contextlib.suppress(SteeringError):  # It has ended then.
                    await self._begin_only()

    async def give_up_start(self, why: str) -> None:
        """Keeps the mission from beginning that waits for its model or is to be started; one that has begun
        goes on.

        The only mission of a system has ended then, as `cancelled`. Whoever starts one of several is told.
        """
        is_first = self.mission is None and not self._has_ended
        if self.is_interrupted or not (is_first or self._starting.locked()):
            return
        self._unwanted = why
        if not self._settings.stay:
            book = self._books.newest
            assert book is not None
            book.end(
                MissionState(book.name, "ended", 0, 0.0, Ending.CANCELLED.value, f"{why} before it began")
            )
        self._ports.publish_state(self.state)
        self._waiting.begin()
        async with self._starting:
            pass

    async def go_on(self) -> None:
        """Takes up the mission that had begun when the solver before this one ended."""
        async with self._starting:
            book = self._books.newest
            if self.mission is not None or book is None:
                return  # Whoever has started the system was quicker.
            running, past = await self._first_model(), None
            earlier = await self._earlier(book, running)
            if book.number:
                running, past, earlier = await self._at_its_start(book, running, earlier)
            self._begin(book, running, book.start, past, earlier=earlier)

    async def running(self) -> Mission | None:
        """Returns the mission that runs, once it is taken up where its solver was started again."""
        if self.mission is None and self.is_interrupted:
            await self._has_begun.wait()
        mission = self.mission
        return mission if mission is not None and mission.state.phase != "ended" else None

    async def run(self) -> None:
        """Runs each mission that begins to its end; returns after the last one."""
        if self._has_ended and not self._settings.stay:
            return
        is_last = False
        while not is_last:
            await self._started.wait()
            self._started.clear()
            mission = self.mission
            assert mission is not None
            await self._mappings.until_dealt_with(mission.state.revision)
            state = await mission.run()
            self.ended.set()
            log.info("the mission ended: %s, %s", state.ending, state.remark)
            is_last = not self._settings.stay

    @property
    def _has_ended(self) -> bool:
        book = self._books.newest
        return self.mission is None and book is not None and book.memory.has_ended

    @property
    def _runs(self) -> bool:
        """Says whether a mission runs, or one that has begun is to be taken up."""
        if self.mission is not None:
            return self.mission.state.phase != "ended"
        return self.is_interrupted

    def _last_drift(self) -> DriftTests | None:
        """The tests of the mission before, which go over to the next one."""
        if self.mission is not None:
            return self.mission.drift
        book = self._books.newest
        return book.memory.drift if book is not None else None

    def _busy(self) -> AosError:
        hint = "Wait for its end, or end it with `aos mission stop`"
        return MissionRunsError(f"the mission {self._books.name} runs", hint=hint)

    def _want(self, start: StartMission) -> None:
        """Takes a start: SteeringError where it is the one that the system begins with, and was given up."""
        if self._unwanted and start.request == Path(self._settings.run_dir).name:
            raise self._given_up()
        self._waiting, self._unwanted = Abandoning(), ""

    async def _unless_given_up(self, work: Coroutine[Any, Any, T]) -> T:
        result = await self._waiting.unless_given_up(work)
        if result is None:
            raise self._given_up()
        return result

    def _given_up(self) -> AosError:
        return SteeringError(f"the mission does not begin: {self._unwanted}", hint="Start it once more")

    async def _begin_only(self) -> None:
        """Begins the only mission of a system that ends with it, or takes it up."""
        book = self._books.newest
        assert book is not None
        running = await self._unless_given_up(self._first_model())
        self._begin(book, running, None, earlier=await self._earlier(book, running))

    async def _earlier(self, book: Logbook, running: RunningModel) -> tuple[Earlier, ...]:
        """The models that the mission had before, as far as its belief has come through them."""
        documents = self._registry.documents
        return await earlier_models(
            book.memory, running, documents, self._settings, lambda text: log.info("%s", text)
        )

    async def _at_its_start(
        self, book: Logbook, running: RunningModel, earlier: tuple[Earlier, ...]
    ) -> tuple[RunningModel, Past, tuple[Earlier, ...]]:
        """Brings the first of the models to the belief that one of several missions began with.

        Returns the running one with an engine of its own, the past of that belief, and the earlier ones.
        """
        first = earlier[0].model if earlier else running
        begun = await self._succession.at_start_of(first, book.number)
        first = replace(first, engine=begun.engine)
        if earlier:
            await earlier[0].model.engine.close()
            earlier = (Earlier(first, earlier[0].until), *earlier[1:])
            own = await running.engine.anew(book.seed, book.memory.mission_parameters)
            first = replace(running, engine=own)
        await self._shelf.turn_to(first, self._succession.values(book.start))
        return first, begun.past, earlier

    async def _begin_next(self, start: StartMission) -> None:
        """Begins the next mission of a system that stays; nothing has changed where that fails."""
        await self._unless_given_up(self._first_model())
        await self._unless_given_up(self._until_accepted_documents_are_ready())
        running = await self._succession.model(self._shelf, await self._first_model(), start, self.mission)
        begun = await self._unless_given_up(self._succession.next(running, start, self.mission))
        running = replace(running, engine=begun.engine)
        await self._shelf.turn_to(running, self._succession.values(start))
        drift = self._last_drift()
        self._begin(self._books.open_next(), running, start, begun.past, drift)

    async def _until_accepted_documents_are_ready(self) -> bool:
        """Waits for what the registry has accepted before the start of a mission, here and in the
        middleware; True once it has waited."""
        await self._registry.adopt_current()
        await self._shelf.made()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(MAPPING_DEADLINE_S):
                while self._shelf.is_unmapped:
                    await self._ports.until_changed(1.0)
        return True

    async def _first_model(self) -> RunningModel:
        return self._shelf.running or await self._shelf.first()

    def _begin(
        self,
        book: Logbook,
        running: RunningModel,
        start: StartMission | None,
        past: Past | None = None,
        drift: DriftTests | None = None,
        earlier: tuple[Earlier, ...] = (),
    ) -> None:
        """Begins a mission or takes it up; that it begins is in the journal."""
        terms = self._terms(book.name, book.seed, book.memory.epoch + 1, running)
        begun = MissionBegun(
            book.name,
            terms.epoch,
            book.seed,
            running.revision,
            running.digest,
            running.engine.description.mission_parameters,
            start,
            bool(earlier),
        )
        book.append(BEGUN, begun)
        memory, book.memory = book.memory, MissionMemory()
        self.mission = Mission(terms, running, self._ports, memory, past, drift, earlier)
        self.ended.clear()
        self._started.set()
        self._has_begun.set()

    def _terms(self, name: str, seed: int, epoch: int, running: RunningModel) -> Terms:
        search = replace(self._settings_as(Search), seed=seed)
        policy = Path(self._settings.policy) if self._settings.policy else None
        return Terms(
            name=name,
            epoch=epoch,
            limits=self._settings_as(MissionLimits),
            search=following(search, policy, engine=running.engine),
            failures=self._settings_as(FailureRules),
            activation_timeout_s=self._settings.activation_timeout_s,
            hold_s=self._settings.hold_s,
        )

    def _settings_as(self, kind: type[T]) -> T:
        """The part of the settings that has the fields of this kind."""
        return msgspec.convert(self._settings, kind, from_attributes=True)
