"""The replay of a mission: an engine that is brought from row to row of its journal as the mission's was.

Documents, decisions and outcomes in their order give the same beliefs bit for bit; with the searches that
were made for each decision, also the same values (docs/decisions/0041). A takeover, another process of the
engine and another solver are done again where they happened.
"""

from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import NamedTuple, Protocol

import msgspec
from msgspec.structs import replace

from aos_protocol import messages
from aos_protocol.documents import Project
from aos_protocol.errors import StudyError
from aos_runtime.background import Closing
from aos_runtime.clock import SystemClock
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.beliefs import ExportedBeliefs
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Restriction
from aos_solver.child.search import Search
from aos_solver.earlier_models import built_for
from aos_solver.mission.models.past import Evidence, Past, evidence_of, updated
from aos_solver.mission.models.takeover import Earlier, RunningModel, Successor, retraced
from aos_solver.mission.records.stretches import Stretch, after, models_before
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules, Failures
from aos_solver.offline.policy import following
from aos_solver.settings import Settings
from aos_solver.study.recorded import RecordedMission

NICENESS = 19
"""A study gives way to everything else on the machine."""


class Documents(Protocol):
    """The source of a mission's documents."""

    async def revision(self, number: int) -> Project:
        """The documents of a revision; AosError if they are gone."""
        ...


class Remade(NamedTuple):
    """A row of the journal and the belief that the replay has there.

    For a decision `plans` has what each of its searches found once more, in their order, as far as decisions
    are made again and the search can be.
    """

    row: int
    said: messages.MissionBegun | messages.ModelAdopted | messages.DecisionRecord
    belief: messages.BeliefSummary
    plans: tuple[Plan | None, ...] = ()


class ReplayedMission(Closing):
    """A mission's past in an engine of its own, at the row that was reached last.

    `engine` is the one that believes what the mission's engine believed there.
    """

    engine: Engine

    def __init__(
        self,
        mission: RecordedMission,
        documents: Documents,
        settings: Settings,
        *,
        on_progress: Callable[[str], None] = lambda text: None,
        decides: bool = False,
        policy: Path | None = None,
        niceness: int = NICENESS,
    ) -> None:
        """Each search is made again where the replay `decides`. A `policy` file is that of the mission."""
        self.mission = mission
        self.documents = documents
        self.settings = settings
        self._on_progress = on_progress
        self._decides = decides
        self._policy = policy
        self._niceness = niceness
        self._running: RunningModel | None = None
        self._failures = Failures(msgspec.convert(settings, FailureRules, from_attributes=True))
        self._limits = msgspec.convert(settings, MissionLimits, from_attributes=True)
        self.past = Past(self._limits.refuted_below)
        self._engine_number = 1
        self._next = 0
        self._step = 0

    def can_go_on(self, mission: RecordedMission, step: int) -> bool:
        """Says whether the replay is of this mission, and not beyond the decision of the step."""
        known = self.mission.events[: self._next]
        return self._step <= step and mission.events[: self._next] == known

    def search_by(self, decision: messages.DecisionRecord) -> Search:
        """The way in which a decision was made, with the mission's budget."""
        search = msgspec.convert(self.settings, Search, from_attributes=True)
        search = replace(search, seed=self.begun.seed)
        return following(search, self._policy if decision.chosen_by == "policy" else None)

    async def rows(self, until: int | None = None) -> AsyncIterator[Remade]:
        """Goes from row to row, from where it is; with `until` it ends at the decision of that step.

        StudyError AOS530 where the journal does not tell what a replay needs.
        """
        while self._next < len(self.mission.events):
            event = self.mission.events[self._next]
            self._next += 1
            match event.said:
                case messages.MissionBegun() as begun:
                    yield Remade(event.row, begun, await self._begin(begun))
                case messages.ModelAdopted() as adopted:
                    yield Remade(event.row, adopted, await self._adopt(adopted))
                case messages.DecisionRecord(outcome=None) as decision:
                    belief, self._step = await self.engine.summary(), decision.step
                    is_last = until is not None and decision.step >= until
                    plans = await self._decided(decision) if self._decides else ()
                    yield Remade(event.row, decision, belief, plans)
                    if is_last:
                        return
                case messages.DecisionRecord() as observed:
                    yield Remade(event.row, observed, await self._observe(observed))

    async def go_to(self, step: int) -> messages.DecisionRecord:
        """Brings the engine to the belief of a step's decision, which is returned; errors as from `rows`."""
        decision = self.mission.decision(step)
        if self._step != step or self._running is None:
            async for _ in self.rows(step):
                pass
        return decision

    async def model(self) -> BuiltModel:
        """The model that decides where the replay is."""
        assert self._running is not None
        return await self.built(self._running.revision)

    @property
    def begun(self) -> messages.MissionBegun:
        """The row with which the mission began."""
        begun = self.mission.begun
        assert begun is not None
        return begun

    @property
    def revision(self) -> int:
        """The revision of the documents where the replay is."""
        assert self._running is not None
        return self._running.revision

    @property
    def goal_probability(self) -> float:
        """The probability of the goal at which the mission ends."""
        return self._limits.goal_probability

    def evidence_of(self, record: messages.DecisionRecord) -> Evidence:
        """The step of a record as a belief sees it; it has an outcome."""
        assert record.outcome is not None
        return evidence_of(record, record.outcome, self._failures)

    async def close(self) -> None:
        """Ends the engine. A closed replay goes nowhere."""
        running, self._running = self._running, None
        if running is not None:
            await running.engine.close()

    async def built(self, revision: int) -> BuiltModel:
        """The model of a revision, with the mission's values."""
        project = await self.documents.revision(revision)
        return await built_for(self.begun, project, self.settings, self._on_progress)

    async def _engine(self, revision: int, digest: str) -> RunningModel:
        built = await self.built(revision)
        if built.emitted.digest != digest:
            message = f"revision {revision} gives another model here: another version of AOS ran it"
            raise StudyError(message, hint="Replay it with the version that `run.json` names")
        engine = await Engine.start(
            built,
            seed=self.begun.seed,
            impossible_observation=self.settings.impossible_observation,
            niceness=self._niceness,
        )
        self._engine_number = 1
        return RunningModel(revision, engine)

    async def _begin(self, begun: messages.MissionBegun) -> messages.BeliefSummary:
        """Begins the mission, or takes it up as another solver did, with the models of that time."""
        await self.close()
        running = await self._engine(begun.revision, begun.model_digest)
        self._running, self.engine = running, running.engine
        if begun.epoch == 1:
            await self._start(begun.start)
        elif self.past.steps or begun.is_retraced:
            if begun.start is not None and not _is_plain(begun.start):
                raise StudyError("a mission that kept a belief was taken up by another solver")
            async for _ in retraced(await self._earlier(begun), running, self.past):
                pass
        return await self.engine.summary()

    async def _earlier(self, begun: messages.MissionBegun) -> tuple[Earlier, ...]:
        """The models through which the solver of that time had brought the belief."""
        if not begun.is_retraced:
            return ()
        stretches: tuple[Stretch, ...] = ()
        steps = 0
        for event in self.mission.events[: self._next - 1]:
            if isinstance(event.said, messages.MissionBegun | messages.ModelAdopted):
                stretches = after(stretches, event.said, steps)
            steps += isinstance(event.said, messages.DecisionRecord) and event.said.outcome is not None
        before = models_before(stretches, begun.model_digest, steps)
        return tuple(
            [Earlier(await self._engine(each.revision, each.model_digest), until) for each, until in before]
        )

    async def _start(self, start: messages.StartMission | None) -> None:
        """The belief that a mission began with: the initial one, or that which its journal has."""
        if start is None or _is_plain(start):
            return
        row = next(self.mission.of_kind(messages.BeliefRow), None)
        if row is None or row.step > 0:
            raise StudyError(
                "the mission began with another belief than the initial one, and did not keep it"
            )
        if any(states.is_drawn for states in row.beliefs):
            raise StudyError("the mission began with particles of the mission before, whose draws go on")
        await self.engine.import_beliefs(ExportedBeliefs(row.words, row.beliefs))

    async def _adopt(self, adopted: messages.ModelAdopted) -> messages.BeliefSummary:
        assert self._running is not None
        successor = Successor(await self._engine(adopted.revision, adopted.model_digest), SystemClock())
        try:
            takeover = None
            while takeover is None:
                takeover = await successor.take_over(self._running, self.past)
        except BaseException:
            await successor.close()
            raise
        if takeover.row.by != adopted.by:
            raise StudyError(
                f"revision {adopted.revision} took over by {adopted.by}, and here by {takeover.row.by}: "
                f"{takeover.row.why or adopted.why}"
            )
        before, self._running = self._running, takeover.model
        self.engine = takeover.model.engine
        await before.engine.close()
        return takeover.belief

    async def _observe(self, record: messages.DecisionRecord) -> messages.BeliefSummary:
        evidence = self.evidence_of(record)
        number = len(self.past) + 1
        update = await updated(self.engine, evidence, self.past.refuted_below, number=number)
        self.past.steps.append(evidence)
        return update.summary

    async def _decided(self, decision: messages.DecisionRecord) -> tuple[Plan | None, ...]:
        """The plans that a decision's searches give once more; None for one that cannot be made again."""
        search = self.search_by(decision)
        plans: list[Plan | None] = []
        for made in decision.searches:
            await self._restart_up_to(made.engine)
            if made.is_pondering or (search.time_s is not None and decision.chosen_by != "policy"):
                plans.append(None)
            else:
                plans.append(await search.run(self.engine, decision.step, self.restriction_of(made)))
        return tuple(plans)

    def restriction_of(self, made: messages.SearchMade) -> Restriction:
        """The actions and the belief that a search was for; actions that the model lacks are left out."""
        numbers = {action.name: number for number, action in enumerate(self.engine.description.actions)}
        barred = [numbers[name] for name in made.barred if name in numbers]
        skills = {action.skill for action in self.engine.description.actions}
        return Restriction(
            barred=barred,
            without=[name for name in made.without if name in skills],
            without_actions=[numbers[name] for name in made.without if name in numbers],
            cautious=made.is_cautious,
        )

    async def _restart_up_to(self, number: int) -> None:
        """Starts the engine's process anew where the mission's was: its searches begin without a tree."""
        while self._engine_number < number:
            await self.engine.forget()
            self._engine_number += 1


def _is_plain(start: messages.StartMission) -> bool:
    """Says whether a mission begins with the initial belief, now."""
    return start.belief == "initial" and not start.idle and not start.given
