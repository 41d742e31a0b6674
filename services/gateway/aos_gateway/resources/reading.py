"""The resources that journals and the bus have: runs, missions, decisions, beliefs, activations."""

import asyncio
from collections.abc import AsyncIterator
from typing import Annotated, Any

import msgspec
from msgspec.structs import replace

from aos_deploy.runs.record import Summary
from aos_gateway.resources.documents import draws_state
from aos_gateway.resources.events import place_of, stream
from aos_gateway.resources.run_files import number_of_step
from aos_gateway.runs.run import KeptRun, RunEntry
from aos_gateway.runs.trace import Trace, steps_of
from aos_gateway.shared import Gateway
from aos_protocol import __version__
from aos_protocol.errors import AosError, GatewayError
from aos_protocol.messages import BeliefSummary, DecisionRecord, History, MissionEntry, MissionState, Outcome

_PAGE = 1000
_TRACE_RECORDS = 4000

Since = Annotated[int, msgspec.Meta(ge=0, le=2**53, description="The first sequence number")]
Limit = Annotated[int, msgspec.Meta(ge=1, le=_PAGE, description="The most that are given")]


class Index(msgspec.Struct, frozen=True):
    """The gateway itself: its version, and where the description of all operations is."""

    aos: str
    openapi: str = "/v1/openapi.json"


class Runs(msgspec.Struct, frozen=True):
    """Runs, the newest first, of `total` that there are."""

    runs: tuple[RunEntry, ...]
    total: int


class MissionView(msgspec.Struct, frozen=True, omit_defaults=True):
    """A mission: the run it belongs to, how it began, its last state, and its summary once it has ended.

    `parameters` are the values of its mission parameters.
    """

    run: str
    robot: str
    is_running: bool
    mission: MissionEntry | None = None
    state: MissionState | None = None
    summary: Summary | None = None
    parameters: dict[str, str] = {}


class MissionList(msgspec.Struct, frozen=True):
    """Missions of all runs, the newest first."""

    missions: tuple[MissionView, ...]
    total: int


class BeliefOfStep(msgspec.Struct, frozen=True):
    """The belief of a step: the one decided on, or where `is_after` the one after its outcome."""

    step: int
    sequence: int
    is_after: bool
    belief: BeliefSummary


class Beliefs(msgspec.Struct, frozen=True):
    """Beliefs in their order; where it `has_more`, go on from `next`."""

    mission: str
    beliefs: tuple[BeliefOfStep, ...]
    next: int
    has_more: bool


class Activation(msgspec.Struct, frozen=True, omit_defaults=True):
    """An activation: what ran, and its outcome with the local variables, once it has ended."""

    step: int
    action: str
    skill: str
    parameters: dict[str, Any]
    outcome: Outcome | None = None


class Activations(msgspec.Struct, frozen=True):
    """Activations in their order; where it `has_more`, go on from the record `next`."""

    mission: str
    activations: tuple[Activation, ...]
    next: int
    has_more: bool


class DecisionView(msgspec.Struct, frozen=True, omit_defaults=True):
    """One step: the record when it was decided, and the one with its outcome."""

    decided: DecisionRecord | None = None
    observed: DecisionRecord | None = None


class Paging(msgspec.Struct, frozen=True):
    """The part of a long list that is wanted."""

    since: Since = 0
    limit: Limit = 200


class Newest(msgspec.Struct, frozen=True):
    """The number of the newest ones that is wanted."""

    limit: Annotated[int, msgspec.Meta(ge=1, le=500)] = 100


class OfTrace(msgspec.Struct, frozen=True):
    """The most steps that are wanted, the newest of them."""

    steps: Annotated[int, msgspec.Meta(ge=1, le=10_000)] = _TRACE_RECORDS // 2


class OfEvents(msgspec.Struct, frozen=True):
    """The mission that is followed, from a record on; without one, the list of runs alone."""

    mission: str = ""
    since: Since = 0


async def index(gateway: Gateway) -> Index:
    """The version of the gateway."""
    return Index(__version__)


async def runs(gateway: Gateway, query: Newest) -> Runs:
    """The runs of this machine and of the systems that the gateway is connected to, the newest first."""
    entries = await gateway.shelf.entries()
    return Runs(entries[: query.limit], len(entries))


async def run(gateway: Gateway, run: str) -> RunEntry:
    """One run."""
    return await gateway.shelf.run(run).entry()


async def missions(gateway: Gateway, query: Newest) -> MissionList:
    """Missions of all runs, the newest first."""
    entries = await gateway.shelf.entries()
    names = [(entry, name) for entry in entries for name in reversed(entry.missions)]
    views = [await mission(gateway, name) for entry, name in names[: query.limit]]
    return MissionList(tuple(views), len(names))


async def mission(gateway: Gateway, mission: str) -> MissionView:
    """One mission: how it began, where it is, how it has ended."""
    found = await gateway.shelf.run_of_mission(mission)
    try:
        entries = await found.missions()
        state = await found.last_state(mission)
        parameters = await found.parameters(mission)
    except AosError:
        entries, state, parameters = (), None, {}  # A run that has not come so far, or a system that is away.
    if state is None and found.is_running:
        state = await found.beginning(mission)
    entry = next((each for each in entries if each.mission == mission), None)
    is_over = state is not None and state.phase == "ended"
    return MissionView(
        run=found.name,
        robot=found.robot,
        is_running=found.is_running and not is_over,
        mission=entry,
        state=state,
        summary=found.summary(mission) if isinstance(found, KeptRun) else None,
        parameters=parameters,
    )


async def decisions(gateway: Gateway, mission: str, query: Paging) -> History:
    """The decision records of a mission from a sequence number on, page by page."""
    found = await gateway.shelf.run_of_mission(mission)
    return await found.page(mission, query.since, query.limit)


async def decision(gateway: Gateway, mission: str, step: str) -> DecisionView:
    """One step of a mission: what was decided, and what came of it."""
    number = number_of_step(step)
    found = await gateway.shelf.run_of_mission(mission)
    decided = observed = None
    since, has_more = max(0, 2 * (number - 1) - 2), True
    while has_more:
        page = await found.page(mission, since, 50)
        for record in page.records:
            if record.step == number:
                decided, observed = (record, observed) if record.outcome is None else (decided, record)
        last = page.records[-1] if page.records else None
        has_more = page.has_more and last is not None and last.step <= number
        since = last.sequence + 1 if last is not None else since
    if decided is None and observed is None:
        raise GatewayError(f"the mission {mission} has no step {number}")
    return DecisionView(decided, observed)


async def beliefs(gateway: Gateway, mission: str, query: Paging) -> Beliefs:
    """The beliefs of a mission, each as a decision record has it."""
    found = await gateway.shelf.run_of_mission(mission)
    page = await found.page(mission, query.since, query.limit)
    told = tuple(
        BeliefOfStep(record.step, record.sequence, record.outcome is not None, record.belief)
        for record in page.records
    )
    return Beliefs(mission, told, told[-1].sequence + 1 if told else query.since, page.has_more)


async def activations(gateway: Gateway, mission: str, query: Paging) -> Activations:
    """The activations of a mission, with their local variables."""
    found = await gateway.shelf.run_of_mission(mission)
    page = await found.page(mission, query.since, query.limit)
    by_step = {
        record.step: Activation(record.step, record.action, record.skill, record.parameters, record.outcome)
        for record in page.records
    }
    following = page.records[-1].sequence + 1 if page.records else query.since
    return Activations(mission, tuple(by_step.values()), following, page.has_more)


async def trace(gateway: Gateway, mission: str, query: OfTrace) -> Trace:
    """The steps of a mission, short: all that views over time need."""
    found = await gateway.shelf.run_of_mission(mission)
    kept = gateway.traces.get(mission, query.steps)
    if kept is not None and not (await found.page(mission, kept.next, 1)).records:
        return kept
    records: list[DecisionRecord] = []
    page = await found.page(mission, 0)
    while page.records:
        records += page.records
        del records[: -2 * query.steps]
        if not page.has_more:
            break
        page = await found.page(mission, page.records[-1].sequence + 1)
    made = await asyncio.to_thread(steps_of, mission, records)
    if records and isinstance(found, KeptRun):
        draws = await asyncio.to_thread(draws_state, found, records[-1].revision)
        made = replace(made, draws=draws)
    gateway.traces.keep(query.steps, made)
    return made


async def events(gateway: Gateway, query: OfEvents, last_event_id: str) -> AsyncIterator[bytes]:
    """The event stream: decisions, states, progress, bundles and services of a mission's system, and the
    runs."""
    mission, since = await gateway.shelf.named(query.mission), query.since
    seen_mission, seen = place_of(last_event_id)
    if seen_mission == mission:
        since = max(since, seen)
    found = await gateway.shelf.run_of_mission(mission) if mission else None
    return stream(gateway.shelf, gateway.watches, found, mission, since)
