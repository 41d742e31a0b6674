"""The study of a mission: questions about its decisions, answered by an engine that is brought to the step.

Live and offline are the same code: only where journal and documents come from differs (`Source`).
"""

import asyncio
import math
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Protocol

from aos_protocol.errors import SkillError
from aos_protocol.messages import (
    BeliefSummary,
    DecisionRecord,
    DecisionTree,
    TreeBranch,
    TreeNode,
    TreeQuery,
    WhatIf,
    WhatIfQuery,
    Why,
    WhyQuery,
)
from aos_runtime.background import Closing
from aos_solver.study.other_circumstances import OtherDocuments, decided_otherwise
from aos_solver.study.reasons import Reasons
from aos_solver.study.recorded import RecordedMission
from aos_solver.study.replaying import ReplayedMission
from aos_solver.study.supposing import put_aside
from aos_solver.study.traced_engines import TracedEngines
from aos_solver.study.valuing import Value, Valuing

FLIPS_S = 0.6
"""The whole answer about an exact decision is to take a second."""


class Source(Protocol):
    """The place where missions are recorded."""

    async def recorded(self, mission: str) -> RecordedMission:
        """The mission of that name as far as its journal goes, the newest for an empty name."""
        ...

    def replay(self, mission: RecordedMission) -> ReplayedMission:
        """A replay of it that makes no decision again."""
        ...

    async def files(self, revision: int) -> dict[str, bytes]: ...


class Study(Closing):
    """Answers one question after the other. Its engines are started when they are needed.

    With a `niceness` engines and compilers give way to whatever else runs. Other beliefs of an exact decision
    are valued for `flips_s` at most, and a model that is compiled for its rewards is waited for `patience_s`.
    """

    def __init__(
        self,
        source: Source,
        cache_dir: Path,
        niceness: int = 0,
        *,
        flips_s: float = FLIPS_S,
        patience_s: float = math.inf,
    ) -> None:
        self._source = source
        self._niceness = niceness
        self._flips_s = flips_s
        self._replay: ReplayedMission | None = None
        self._traced = TracedEngines(cache_dir, niceness, patience_s)
        self._asking = asyncio.Lock()

    async def why(self, query: WhyQuery) -> Why:
        """Explains a decision; StudyError AOS530 where that cannot be, SkillError AOS501 for an unknown
        step or action."""
        async with self._asked(query) as (replay, decision):
            return await Reasons(replay, decision, self._traced, self._flips_s).why(query.instead)

    async def what_if(self, query: WhatIfQuery) -> WhatIf:
        """The decision under other circumstances; errors as from `why`."""
        async with self._asked(query) as (replay, decision):
            others = OtherDocuments(self._source.files, self._niceness)
            return await decided_otherwise(replay, decision, query, others)

    async def tree(self, query: TreeQuery) -> DecisionTree:
        """The tree below a decision; errors as from `why`."""
        async with self._asked(query) as (replay, decision):
            return await tree_below(replay, decision, query)

    async def close(self) -> None:
        """Ends the engines; whatever is asked afterwards starts others."""
        async with self._asking:
            await self._drop()
            await self._traced.close()

    @asynccontextmanager
    async def _asked(
        self, query: WhyQuery | WhatIfQuery | TreeQuery
    ) -> AsyncIterator[tuple[ReplayedMission, DecisionRecord]]:
        """A replay at the decision of a question, which has it alone while it is answered."""
        async with self._asking:
            at_decision = await self._at(query.mission, query.step)
            try:
                yield at_decision
            except SkillError:
                raise  # The engine is where it was.
            except BaseException:
                await self._drop()
                raise

    async def _at(self, mission: str, step: int) -> tuple[ReplayedMission, DecisionRecord]:
        """A replay at the belief of a step's decision, from where the last question has left it if it can."""
        recorded = await self._source.recorded(mission)
        decision = recorded.decision(step)
        step = decision.step
        replay = self._replay
        if replay is None or not replay.can_go_on(recorded, step):
            await self._drop()
            self._replay = replay = self._source.replay(recorded)
        try:
            replay.mission = recorded
            await replay.go_to(step)
        except BaseException:
            await self._drop()
            raise
        return replay, decision

    async def _drop(self) -> None:
        replay, self._replay = self._replay, None
        if replay is not None:
            await replay.close()


MOST_NODES = 500
"""A larger tree is cut."""

_OVER = 1e-9


async def tree_below(replay: ReplayedMission, decision: DecisionRecord, query: TreeQuery) -> DecisionTree:
    """The tree below the decision at which a replay is; the replay stays there."""
    growing = _Growing(replay, decision, query)
    async with put_aside(replay.engine):
        root = await growing.node((), query.depth)
    return DecisionTree(decision.mission, decision.step, root, growing.is_whole)


class _Growing:
    def __init__(self, replay: ReplayedMission, decision: DecisionRecord, query: TreeQuery) -> None:
        self._replay = replay
        self._query = query
        self._valuing = Valuing(replay, decision)
        self._nodes = 0
        self._share = 1.0 / max(min((query.branches**2) ** (query.depth - 1), MOST_NODES), 1)
        self.is_whole = True

    async def node(self, path: Sequence[tuple[str, str]], depth: int) -> TreeNode:
        """The node after these actions and responses; the engine believes that afterwards."""
        self._nodes += 1
        engine = self._replay.engine
        belief = await self._believe(path)
        ended = belief.goal_probability + belief.failure_probability + belief.over_probability
        horizon = self._valuing.horizon
        if ended >= 1 - _OVER or belief.goal_probability >= self._replay.goal_probability:
            return TreeNode(belief.goal_probability, horizon)
        values = await self._valuing.values(engine, share=1.0 if not path else self._share)
        best = sorted(values, key=lambda name: -values[name].q)[: self._query.branches]
        branches = [await self._branch(path, name, values[name], depth) for name in best]
        return TreeNode(belief.goal_probability, horizon, tuple(branches))

    async def _branch(
        self, path: Sequence[tuple[str, str]], action: str, value: Value, depth: int
    ) -> TreeBranch:
        if depth <= 1:
            return TreeBranch(action, value.q, value.n, value.stderr)
        engine = self._replay.engine
        await self._believe(path)
        index = [known.name for known in engine.description.actions].index(action)
        predicted = (await engine.predict(index, cautious=self._valuing.within.cautious)).predicted
        likely = sorted(predicted, key=lambda each: -each.probability)[: self._query.branches]
        after = []
        for each in likely:
            if self._nodes >= MOST_NODES:
                self.is_whole = False
                break
            node = await self.node((*path, (action, each.response)), depth - 1)
            after.append((each.response, each.probability, node))
        return TreeBranch(action, value.q, value.n, value.stderr, tuple(after))

    async def _believe(self, path: Sequence[tuple[str, str]]) -> BeliefSummary:
        """The belief after these actions and responses."""
        belief = await self._replay.engine.take_back()
        refuted_below = self._replay.past.refuted_below
        for number, (action, response) in enumerate(path, len(self._replay.past) + 1):
            update = await self._replay.engine.update(
                action, response, refuted_below=refuted_below, step=number
            )
            belief = update.summary
        return belief
