"""Metrics of missions, for Prometheus: counted out of their records whenever somebody asks.

Sums begin with 0 when the gateway begins, and missions that had ended before are in none; of a system
elsewhere those that had ended at the first question. A mission that ran at that moment is counted from its
first step. Nothing is read while nobody asks; what a mission has recorded between two scrapes is counted with
the second, so that none is lost.
"""

import asyncio
import logging
from collections import Counter as Multiset
from collections.abc import Iterable
from contextlib import suppress

from aos_deploy.processes.consequence import STARTED_AGAIN
from aos_gateway.metrics.exposition import Counter, Family, Gauge, Histogram, exposition
from aos_gateway.runs.run import KeptRun, Run, RunEntry
from aos_gateway.runs.shelf import RunShelf
from aos_protocol.errors import ANOTHER_MAY_MOVE, AosError
from aos_protocol.messages import DecisionRecord, MissionEntry, MissionState
from aos_protocol.mission_rows import STATE
from aos_runtime.disk.journal import Journal
from aos_runtime.disk.mission_folders import JOURNAL
from aos_solver.mission.records.logbook import entries_of

_log = logging.getLogger("aos.gateway")


class _Mission:
    """The place up to which a mission is counted."""

    def __init__(self) -> None:
        self.next_sequence = 0
        self.next_row = 0
        self.goal_probability: float | None = None
        self.is_holding = False
        self.has_ended = False
        self.was_killed = False


class _Counted:
    """The place up to which a run is counted."""

    def __init__(self) -> None:
        self.missions: dict[str, _Mission] = {}
        self.engine_starts: dict[str, int] = {}
        self.pids: dict[str, int] = {}
        self.restarts: Multiset[str] = Multiset()
        self.ended_before: frozenset[str] | None = None
        self.was_killed = False
        self.is_over = False


class Metrics:
    """The metrics of the runs on a shelf."""

    def __init__(self, shelf: RunShelf) -> None:
        self._shelf = shelf
        self._families = Families()
        self._counted: dict[str, _Counted] = {}
        self._asked = asyncio.Lock()
        for name, run in shelf.runs().items():
            if isinstance(run, KeptRun):
                self._begin(run, self._of(name))

    async def text(self) -> bytes:
        """The metrics now, in Prometheus' text format."""
        async with self._asked:
            runs = await asyncio.to_thread(self._shelf.runs)
            for name, run in runs.items():
                counted = self._of(name)
                if not counted.is_over or run.is_running:
                    await self._count(run, counted)
            self._show_living(runs)
            return exposition(self._families.all)

    def _of(self, run: str) -> _Counted:
        return self._counted.setdefault(run, _Counted())

    @staticmethod
    def _begin(run: KeptRun, counted: _Counted) -> None:
        """Takes note of what was before the gateway. A run without a summary may be taken up."""
        counted.was_killed = not run.is_running and run.directory.read_summary() is None
        counted.is_over = not run.is_running and not counted.was_killed
        if not counted.is_over:
            with suppress(AosError):
                counted.ended_before = _ended(entries_of(run.directory.path))

    async def _count(self, run: Run, counted: _Counted) -> None:
        try:
            # First whether it is over: whatever is read after that is all that there will be.
            entry = await run.entry()
            if counted.was_killed and entry.ending == "killed":
                return  # Nobody has taken it up.
            counted.was_killed = entry.ending == "killed"
            missions = await run.missions()
            if counted.ended_before is None:
                counted.ended_before = frozenset() if isinstance(run, KeptRun) else _ended(missions)
            known = {each.mission: each for each in missions}
            for mission in entry.missions:
                place = counted.missions.setdefault(mission, _Mission())
                if place.was_killed and not counted.was_killed:
                    place.has_ended = place.was_killed = False  # It was taken up.
                if not place.has_ended:
                    await self._count_mission(run, entry, known.get(mission), mission)
            if isinstance(run, KeptRun):
                await asyncio.to_thread(self._count_restarts, run, counted)
            counted.is_over = not entry.is_running and isinstance(run, KeptRun) and not counted.was_killed
        except AosError as error:
            _log.warning("the metrics of %s are not whole: %s", run.name, error)
            self._families.unreadable.add(robot=run.robot)
            counted.is_over = not run.is_running

    async def _count_mission(
        self, run: Run, entry: RunEntry, known: MissionEntry | None, mission: str
    ) -> None:
        counted = self._of(run.name)
        place = counted.missions[mission]
        if counted.ended_before and mission in counted.ended_before:
            place.has_ended = True
            return
        has_more = True
        while has_more:
            page = await run.page(mission, place.next_sequence)
            for record in page.records:
                self._families.take(run.robot, record, counted.engine_starts)
                place.next_sequence = record.sequence + 1
                place.goal_probability = record.belief.goal_probability
            has_more = page.has_more
        if isinstance(run, KeptRun):
            await asyncio.to_thread(self._count_holds, run, mission, place)
        ending = known.ending if known is not None and known.ended_ns else ""
        if not ending and not entry.is_running and entry.ending not in ("stopped", "unreachable"):
            ending = entry.ending  # The run has ended otherwise than by its mission.
        if ending:
            place.has_ended = True
            place.was_killed = ending == "killed"
            self._families.missions.add(robot=run.robot, ending=ending)

    def _count_holds(self, run: KeptRun, mission: str, place: _Mission) -> None:
        journal = run.folder(mission) / JOURNAL
        if not journal.exists():
            return
        with Journal.read(journal) as rows:
            for row in rows.walk(STATE, place.next_row):
                place.next_row = row.seq + 1
                state = row.read_as(MissionState)
                is_holding = state.phase == "holding"
                if is_holding and not place.is_holding:
                    by = "operator" if state.held_by else "skill"
                    self._families.holds.add(robot=run.robot, held_for=by)
                place.is_holding = is_holding

    def _count_restarts(self, run: KeptRun, counted: _Counted) -> None:
        """Counts new process ids while a run goes on; at its end the summary has all restarts."""
        pids = run.directory.read_record().pids
        summary = run.directory.read_summary()
        before = Multiset(counted.restarts)
        counted.restarts.update(name for name, pid in pids.items() if counted.pids.get(name, pid) != pid)
        counted.pids |= pids
        if summary is not None:
            counted.restarts |= Multiset(
                end.name for end in summary.process_ends if end.then == STARTED_AGAIN
            )
        for service, number in (counted.restarts - before).items():
            self._families.service_restarts.add(number, robot=run.robot, service=service)

    def _show_living(self, runs: dict[str, Run]) -> None:
        families = self._families
        families.forget_gauges()
        for name, run in runs.items():
            for mission, place in self._of(name).missions.items():
                if place.has_ended or self._of(name).is_over:
                    continue
                families.running.add(robot=run.robot)
                if isinstance(run, KeptRun):  # Of a system at an endpoint nobody knows it.
                    families.holding.add(float(place.is_holding), robot=run.robot)
                if place.goal_probability is not None:
                    families.goal.set(place.goal_probability, robot=run.robot, mission=mission)


def _ended(missions: Iterable[MissionEntry]) -> frozenset[str]:
    return frozenset(each.mission for each in missions if each.ended_ns)


_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0)
_NATS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0)


class Families:
    """All metrics. Sums have the label `robot`, and none has a mission, so that there are few of them."""

    def __init__(self) -> None:
        self.missions = Counter("aos_missions_total", "Missions that have ended, by ending.")
        self.running = Gauge("aos_missions_running", "Missions that go on.")
        self.holding = Gauge("aos_missions_holding", "Missions that go on and hold.")
        self.goal = Gauge("aos_goal_probability", "Probability of the goal in the belief of a mission.")
        self.steps = Counter("aos_steps_total", "Steps whose outcome is known.")
        self.decision_s = Histogram(
            "aos_decision_seconds", "Seconds that a decision took, by who chose the action.", _SECONDS
        )
        self.simulations = Counter("aos_simulations_total", "Simulations of all searches.")
        self.surprise = Histogram(
            "aos_surprise_nats",
            "Surprise of outcomes: -log of the predicted probability, or of a density where numbers came.",
            _NATS,
        )
        self.impossible = Counter(
            "aos_impossible_outcomes_total", "Outcomes that the model says cannot be, by skill."
        )
        self.failures = Counter(
            "aos_skill_failures_total",
            "Activations that failed, by skill and status; `observed` where a rule tells a failure.",
        )
        self.activations = Counter("aos_activations_total", "Activations that are over, by skill.")
        self.holds = Counter("aos_holds_total", "Holds, for an operator or for a skill that cannot be run.")
        self.engine_restarts = Counter(
            "aos_engine_restarts_total", "New starts of engines that had ended, or whose search was given up."
        )
        self.service_restarts = Counter(
            "aos_service_restarts_total", "New starts of services that had ended, by service."
        )
        self.drift = Counter(
            "aos_drift_alarms_total", "Alarms that a skill does not report what its model predicts."
        )
        self.unreadable = Counter(
            "aos_unreadable_runs_total", "Scrapes at which the records of a run could not be read."
        )
        self.all: tuple[Family, ...] = tuple(
            family for family in vars(self).values() if isinstance(family, Family)
        )

    def take(self, robot: str, record: DecisionRecord, engine_starts: dict[str, int]) -> None:
        """Counts a record. `engine_starts` has those known of the run's models, and is brought up to date."""
        before = engine_starts.get(record.model_digest, 1)
        again = record.engine_starts - (before if record.engine_starts >= before else 1)
        self.engine_restarts.add(again, robot=robot)
        engine_starts[record.model_digest] = record.engine_starts
        if record.outcome is None:
            self._take_decision(robot, record)
            return
        self.steps.add(robot=robot)
        self.activations.add(robot=robot, skill=record.skill)
        code = "" if record.outcome.fault is None else record.outcome.fault.code
        has_failed = record.outcome.status != "observed" or code != ""
        if has_failed and code != ANOTHER_MAY_MOVE:
            self.failures.add(robot=robot, skill=record.skill, status=record.outcome.status)
        if record.is_impossible:
            self.impossible.add(robot=robot, skill=record.skill)
        elif record.outcome.status == "observed":
            self.surprise.observe(record.surprise, robot=robot)
        for alarm in record.drift:
            if alarm.is_new:
                self.drift.add(robot=robot, skill=alarm.skill, response=alarm.response)

    def forget_gauges(self) -> None:
        """Forgets what held at the scrape before."""
        for family in self.all:
            if isinstance(family, Gauge):
                family.clear()

    def _take_decision(self, robot: str, record: DecisionRecord) -> None:
        self.decision_s.observe(record.planning_s, robot=robot, chosen_by=record.chosen_by)
        made = sum(sum(search.simulations) for search in record.searches)
        self.simulations.add(made, robot=robot)
