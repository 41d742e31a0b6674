"""A small client for whoever wants to follow a robot from Python.

async with AosClient.of_run("runs/latest") as aos:
    async for record in aos.decisions():
        print(record.step, record.action)
"""

from __future__ import annotations

import logging
import uuid
from collections.abc import AsyncGenerator, AsyncIterator, Iterable, Mapping
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec
from msgspec.structs import replace

from aos_protocol import messages
from aos_protocol.access import OPERATOR, WATCHER, Party
from aos_protocol.codec import UNREADABLE
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import BusError, LateAnswerError, LostAnswerError, NobodyAnswersError, SkillError
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Access, Bus
from aos_runtime.bus.credentials import Credential, credential_of_environment, credential_of_run
from aos_runtime.bus.subscription import Subscription, merged
from aos_runtime.older_python import timeout
from aos_runtime.parties.asking import ask_until_answered
from aos_runtime.parties.decision_feed import DecisionFeed
from aos_runtime.parties.reported_state import state_when
from aos_runtime.parties.steering import STEER_TIMEOUT_S, SteeringQuestions, start_mission

_ANSWER_S = 5.0
_PUSH_TIMEOUT_S = 200.0
"""The registry lets the solver compile a new model before it accepts it."""
_ADAPTERS_S = 3.0
"""An adapter that serves whatever documents name has this long to take up a new skill."""
_TO_BIND = "It is chosen once an adapter serves its path: see `bind:` in the deploy file"
_PAGE_RECORDS = 1000
_HISTORY_TRIES = 3
"""A solver that builds or plans on all cores may be late with an answer."""

_log = logging.getLogger("aos.client")

R = TypeVar("R", bound=messages.Message)

SOLVER_AWAY_S = 15.0
"""A solver that is started again is back within this time."""


STUDY_TIMEOUT_S = 600.0
"""A study begins with a replay, and may compile a model."""


class _Place(msgspec.Struct):
    """The part of `run.json` that a client needs."""

    endpoint: str
    robot: str


class AosClient(SteeringQuestions):
    """A watcher of one robot, who can start, steer and stop missions as its operator.

    Watching changes nothing. `by` is the name under which missions are steered; by default user and host of
    this process.
    """

    def __init__(self, bus: Bus, robot: str, by: str = "") -> None:
        super().__init__(bus, Keys(robot), by)

    @classmethod
    @asynccontextmanager
    async def connect(
        cls,
        endpoint: str,
        robot: str,
        *,
        connect_timeout_s: float = 5.0,
        credential: Credential | None = None,
        by: str = "",
    ) -> AsyncIterator[AosClient]:
        """A client of the system at `endpoint`; BusError AOS605 if none is there in time.

        Without a `credential` it is who AOS_USER and AOS_PASSWORD_FILE say.
        """
        credential = credential or credential_of_environment()
        bus = await Bus.open(
            endpoint,
            sender="client",
            connect_timeout_s=connect_timeout_s,
            credential=credential,
            access=_access_of(robot, credential),
        )
        async with bus:
            yield cls(bus, robot, by)

    @classmethod
    @asynccontextmanager
    async def of_run(
        cls, run: str | Path, user: str = WATCHER, *, connect_timeout_s: float = 5.0, by: str = ""
    ) -> AsyncIterator[AosClient]:
        """A client of the system that has this run directory, as its `watcher` or its `operator`.

        BusError AOS605 if this is no run directory, or the run is over.
        """
        place, credential = _place_of(Path(run), user)
        connected = cls.connect(
            place.endpoint, place.robot, connect_timeout_s=connect_timeout_s, credential=credential, by=by
        )
        async with AsyncExitStack() as stack:
            try:
                client = await stack.enter_async_context(connected)
            except BusError as error:
                if not (Path(run) / "summary.json").exists():
                    raise
                raise BusError(f"{run} is over", code="AOS605", hint="See `aos runs`") from error
            yield client

    async def mission_state(self) -> messages.MissionState:
        """Asks for the mission's state now; NobodyAnswersError if there is no solver."""
        return await self._ask(self.keys.mission_state, messages.MissionQuery(), messages.MissionState)

    async def start_mission(
        self,
        *,
        belief: Literal["initial", "keep"] = "initial",
        given: Iterable[str] = (),
        idle: int = 0,
        values: Mapping[str, str] | None = None,
    ) -> messages.MissionState:
        """Begins the next mission of a system that stays, once; what to give is as in StartMission.

        AosError with the reason if it cannot begin: SkillError AOS515 while one runs.
        """
        start = messages.StartMission(
            belief, tuple(given), idle, dict(values or {}), request=uuid.uuid4().hex
        )
        return await start_mission(self.bus, self.keys, start)

    async def stop_mission(self, mission: str = "") -> messages.MissionState:
        """Ends the mission that runs as `cancelled`, and returns when it has ended.

        Where none runs, or another one than the `mission` that is named, nothing changes.
        """
        return await ask_until_answered(
            self.bus,
            self.keys.stop_mission,
            messages.StopMission(mission, by=self.by),
            messages.MissionState,
            server=self.keys.live("solver"),
            timeout_s=STEER_TIMEOUT_S,
        )

    async def push(self, files: dict[str, bytes], source: str) -> messages.BundleReport:
        """Gives the registry documents. Its report also warns of what is new and nobody could run now.

        Errors are those of `Bus.ask`.
        """
        bus, keys = self.bus, self.keys
        bundle = messages.PushBundle(files, source)
        report = await bus.ask(keys.push_bundle, bundle, messages.BundleReport, timeout_s=_PUSH_TIMEOUT_S)
        async with bus.presence(keys.live("middleware")) as middleware:
            if not (report.is_accepted and middleware.has_items):
                return report
        away: dict[str, str] = {}

        def can_be_run(state: messages.MappingState) -> bool:
            nonlocal away
            new = {*report.added, *report.changed}
            away = {skill: why for skill, why in state.unavailable.items() if skill in new}
            return not away and max(state.revision, state.refused) >= report.revision

        with suppress(BusError):
            await state_when(
                bus,
                keys.mapping_state,
                messages.MappingQuery(),
                messages.MappingState,
                can_be_run,
                timeout_s=_ADAPTERS_S,
            )
        warnings = (
            Diagnostic(Severity.WARNING, "AOS505", f"nobody can run it now: {why}", Span(skill), _TO_BIND)
            for skill, why in away.items()
        )
        return replace(report, diagnostics=(*report.diagnostics, *warnings))

    async def catalogue(self) -> messages.Catalogue:
        """The projects that the registry holds."""
        return await self._ask(self.keys.catalogue, messages.CatalogueQuery(), messages.Catalogue)

    async def project(self, name: str = "", revision: int = 0) -> messages.ProjectRevision:
        """A project's documents in its newest or another revision. The only project needs no name."""
        return await self._ask(
            self.keys.project, messages.ProjectQuery(name, revision), messages.ProjectRevision
        )

    async def revisions(self, project: str) -> messages.Revisions:
        """The revisions of a project. The only one needs no name."""
        return await self._ask(self.keys.bundle_history, messages.RevisionsQuery(project), messages.Revisions)

    async def remove(self, project: str, skill: str = "") -> messages.BundleReport:
        """Takes a skill, or a whole project, out of the catalogue."""
        request = messages.RemoveDocuments(project, skill)
        return await self._ask(self.keys.remove_bundle, request, messages.BundleReport, _PUSH_TIMEOUT_S)

    async def mapping_state(self) -> messages.MappingState:
        """The revision that the middleware runs, and the skills that nobody can run."""
        return await self._ask(self.keys.mapping_state, messages.MappingQuery(), messages.MappingState)

    async def _ask(
        self, key: str, query: messages.Message, reply: type[R], timeout_s: float | None = None
    ) -> R:
        return await self.bus.ask(key, query, reply, timeout_s=timeout_s or _ANSWER_S)

    async def missions(self) -> messages.Missions:
        """The missions of the system so far."""
        return await self._ask(self.keys.missions, messages.MissionsQuery(), messages.Missions)

    async def why(self, step: int, *, instead: str = "", mission: int | None = None) -> messages.Why:
        """The reasons for the decision of a step, and not for `instead` another action.

        The mission is the newest one, or that of a number in a system that stays. StudyError AOS530 where it
        cannot be told; SkillError AOS501 for a step or an action that there is not.
        """
        query = messages.WhyQuery(step, instead, await self._named(mission))
        return await self._ask(self.keys.study_why, query, messages.Why, STUDY_TIMEOUT_S)

    async def what_if(self, query: messages.WhatIfQuery, *, mission: int | None = None) -> messages.WhatIf:
        """The decision of a step under other circumstances; errors as from `why`."""
        query = replace(query, mission=await self._named(mission))
        return await self._ask(self.keys.study_whatif, query, messages.WhatIf, STUDY_TIMEOUT_S)

    async def tree(self, query: messages.TreeQuery) -> messages.DecisionTree:
        """The tree below a decision; errors as from `why`."""
        return await self._ask(self.keys.study_tree, query, messages.DecisionTree, STUDY_TIMEOUT_S)

    async def _named(self, mission: int | None) -> str:
        """The name of a mission by its number; empty for the newest one."""
        return "" if mission is None else _found(await self.missions(), mission).mission

    async def until_ended(self, mission: str) -> messages.MissionEntry:
        """Returns how a mission has ended, once it has.

        NobodyAnswersError where the solver has gone for good; SkillError AOS501 if there is no such mission.
        """
        keys = self.keys
        stream = merged(
            self.bus.listen(keys.mission_state, messages.MissionState), self.bus.presence(keys.live("solver"))
        )
        may_wait_s: float | None = SOLVER_AWAY_S
        async with stream:
            while True:
                event = await _next(stream, may_wait_s)
                if event is None:
                    raise NobodyAnswersError(f"the solver has left before the end of {mission}")
                if isinstance(event, bool):
                    may_wait_s = None if event else SOLVER_AWAY_S
                is_news = event is True or (
                    isinstance(event, messages.MissionState) and _may_end(event, mission)
                )
                entry = await self._entry(mission) if is_news else None
                if entry is not None and entry.ended_ns:
                    return entry

    async def _entry(self, mission: str) -> messages.MissionEntry | None:
        """The entry of a mission; None while it has not begun, or nobody answers."""
        try:
            missions = await self.missions()
            is_known = any(entry.mission == mission for entry in missions.entries)
            if not is_known and (await self.mission_state()).mission == mission:
                return None
            return _found(missions, mission)
        except (LateAnswerError, NobodyAnswersError, LostAnswerError):
            return None  # There is news when it is back.

    async def decisions(self) -> AsyncIterator[messages.DecisionRecord]:
        """Every decision record from the first, each once and in order, until the mission ends.

        Who joins late gets what was before, and a gap in the stream is filled from the solver's history. If
        the solver is not there yet, waits for it; ends when it has gone for good.
        """
        async for event in self.follow():
            if isinstance(event, messages.DecisionRecord):
                yield event

    async def follow(
        self, *, away_s: float | None = SOLVER_AWAY_S, begins_s: float | None = None, stays: bool = False
    ) -> AsyncGenerator[messages.DecisionRecord | messages.MissionState | messages.BundleReport, None]:
        """Yields what `decisions` yields, each change of the mission's state, and what becomes of dropped
        bundles.

        The stream goes on with a solver that is started again, and with `stays` with the missions that
        follow. It ends when the solver was away for `away_s`, or has not come within `begins_s`; never where
        these are None.
        """
        keys = self.keys
        feed = DecisionFeed()
        stream = merged(
            self.bus.listen(keys.decisions, messages.DecisionRecord),
            self.bus.listen(keys.mission_state, messages.MissionState),
            self.bus.listen(keys.bundle_report, messages.BundleReport),
            self.bus.presence(keys.live("solver")),
        )
        may_wait_s = begins_s
        async with stream:
            while (event := await _next(stream, may_wait_s)) is not None:
                if isinstance(event, bool):
                    may_wait_s = None if event else away_s
                state = await self._state_if_there() if event is True else None
                if isinstance(event, messages.MissionState):
                    state = event
                is_over = state is not None and state.phase == "ended"
                for record in feed.take(event) if isinstance(event, messages.DecisionRecord) else ():
                    yield record
                if feed.has_gap or event is True or is_over:
                    async for record in self._missing(feed):
                        yield record
                if state is not None:
                    yield state
                if isinstance(event, messages.BundleReport):
                    yield event
                if is_over and not stays:
                    return

    async def history(self) -> AsyncIterator[messages.DecisionRecord]:
        """Every record that there is by now, page after page.

        NobodyAnswersError if there is no solver; BusError if it does not answer.
        """
        page = await self._page(0)
        while page.records:
            for record in page.records:
                yield record
            if not page.has_more:
                return
            page = await self._page(page.records[-1].sequence + 1)

    async def page(self, query: messages.HistoryQuery) -> messages.History:
        """A part of a mission's records; errors as from `history`."""
        return await self._ask(self.keys.decision_history, query, messages.History)

    async def _missing(self, feed: DecisionFeed) -> AsyncIterator[messages.DecisionRecord]:
        """The records from the history that the feed lacks; none if the solver has gone."""
        has_more = True
        while has_more:
            since = feed.next_sequence
            try:
                page = await self._page(since)
            except (NobodyAnswersError, LostAnswerError):
                return
            except BusError as error:
                _log.warning("the history from record %d on is missing: %s", since, error)
                return
            for record in feed.take_history(page):
                yield record
            # Those of another mission begin anew.
            has_more = feed.next_sequence < since or (page.has_more and feed.next_sequence > since)

    async def _page(self, since: int) -> messages.History:
        query = messages.HistoryQuery(since, _PAGE_RECORDS)
        for _ in range(_HISTORY_TRIES - 1):
            try:
                return await self.page(query)
            except LateAnswerError as error:
                _log.info("%s; asked again", error)
        return await self.page(query)

    async def _state_if_there(self) -> messages.MissionState | None:
        try:
            return await self.mission_state()
        except BusError:
            return None


def _found(missions: messages.Missions, wanted: str | int) -> messages.MissionEntry:
    """The mission of a name or a number; SkillError AOS501 if there is none."""
    for entry in missions.entries:
        if wanted in (entry.mission, entry.number):
            return entry
    raise SkillError(f"there is no mission {wanted}", code="AOS501", hint="See `aos mission list`")


def _place_of(run: Path, user: str) -> tuple[_Place, Credential | None]:
    """The place of a run's bus, and who somebody is on it."""
    run = run.resolve()
    try:
        place = msgspec.json.decode((run / "run.json").read_bytes(), type=_Place)
    except (OSError, *UNREADABLE) as error:
        why = getattr(error, "strerror", None) or error
        raise BusError(f"{run} is no run directory: run.json: {why}", code="AOS605") from error
    return place, credential_of_run(run, user)


def _access_of(robot: str, credential: Credential | None) -> Access | None:
    """The table's rows of a client; None for an adapter, whose paths are not known here."""
    if credential is None or credential.user not in (OPERATOR, WATCHER):
        return None
    return Access(robot, Party(name=credential.user, role=credential.user))


def _may_end(state: messages.MissionState, mission: str) -> bool:
    """Says whether a state tells that a mission has ended: its own end, or what another one does."""
    return state.phase == "ended" or state.mission != mission


async def _next(stream: Subscription[Any], timeout_s: float | None) -> Any:
    """Returns the next event; None when the stream has ended, or nothing comes in time."""
    try:
        async with timeout(timeout_s):
            _, event = await anext(stream)
    except (StopAsyncIteration, TimeoutError):
        return None
    return event
