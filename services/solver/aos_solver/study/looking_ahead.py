"""The tree below a decision: best actions, likely responses, the beliefs after them, each planned anew."""

from collections.abc import Sequence

from aos_protocol.messages import BeliefSummary, DecisionRecord, DecisionTree, TreeBranch, TreeNode, TreeQuery
from aos_solver.study.aside import put_aside
from aos_solver.study.replaying import ReplayedMission
from aos_solver.study.valuing import Value, Valuing

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
