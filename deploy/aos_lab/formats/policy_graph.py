"""A policy as a graph: a node says what to do, and for each observation which node comes next.

Whoever follows it needs no belief and no model. Nodes are beliefs that the policy reaches, the likeliest
first; a belief beyond the limit becomes a node with the same plan that is there already. What following the
graph gives is computed exactly, so that nothing is lost unseen.
"""

from __future__ import annotations

import hashlib
import heapq
from collections.abc import Iterator

import msgspec
import numpy as np

from aos_solver.offline.alpha_vectors import AlphaVectors
from aos_solver.offline.explicit_model import ExplicitModel, Floats, Integers

OVER = -1
"""The mark in place of a node where the mission is over."""

_NEGLIGIBLE = 1e-9
_ROUNDING_DIGITS = 9
_MAX_SWEEPS = 20_000
_SETTLED = 1e-8
_FORGOTTEN = np.zeros(0)
"""The belief of a node that is finished; there may be thousands over many states."""


class GraphNode(msgspec.Struct, frozen=True):
    """Take `action`; after an observation go to the node of that number, or OVER. Others are not expected."""

    action: int
    next: dict[int, int]


class PolicyGraph(msgspec.Struct, frozen=True):
    """The graph for a model. `starts` has a node for each of the model's start beliefs, `value` is what
    following it gives from the start, discounted. `is_whole` says that no belief had to be put to another."""

    model: ExplicitModel
    nodes: tuple[GraphNode, ...]
    starts: tuple[int, ...]
    value: float
    is_whole: bool


def policy_graph(model: ExplicitModel, vectors: AlphaVectors, *, max_nodes: int = 200) -> PolicyGraph:
    """The graph of a policy with at most so many nodes, or a few more where no node has the same plan."""
    building = _Building(model, vectors, max_nodes)
    building.grow()
    nodes = tuple(GraphNode(node.action, node.next) for node in building.nodes)
    starts = tuple(building.starts)
    return PolicyGraph(model, nodes, starts, _value(building, nodes), building.is_whole)


class _Node(msgspec.Struct):
    region: int
    belief: Floats
    action: int
    plan: int
    reach: float
    next: dict[int, int]


class _Building:
    """Beliefs from the start on, the likeliest first."""

    def __init__(self, model: ExplicitModel, vectors: AlphaVectors, max_nodes: int) -> None:
        self.model = model
        self._vectors = vectors
        self._max_nodes = max_nodes
        self._matrices = _Matrices(model)
        self._known: dict[bytes, int] = {}
        self._by_plan: dict[int, int] = {}
        self._waiting: list[tuple[float, int]] = []
        self.nodes: list[_Node] = []
        self._region_of, self._place_of = vectors.region_of(len(model.states))
        self.is_whole = True
        self.starts = [self._start(start.weight, start.states, start.probabilities) for start in model.starts]

    def grow(self) -> None:
        """Follows every observation of every node."""
        while self._waiting:
            _, number = heapq.heappop(self._waiting)
            node = self.nodes[number]
            for observation, weights in self._matrices.successors(node.belief, node.action):
                probability = float(weights.sum())
                if probability > _NEGLIGIBLE:
                    reach = node.reach * probability * self.model.discount
                    node.next[observation] = self._node(weights / probability, reach)
            node.belief = _FORGOTTEN

    def _start(self, weight: float, states: Integers, probabilities: Floats) -> int:
        belief = np.zeros(len(self.model.states))
        np.add.at(belief, states, probabilities)
        return self._node(belief, weight)

    def _node(self, belief: Floats, reach: float) -> int:
        rounded = np.round(belief, _ROUNDING_DIGITS).tobytes()
        key = hashlib.blake2b(rounded, digest_size=16).digest()
        if key in self._known:
            return self._known[key]
        plan, action = self._plan(belief)
        if plan == OVER:
            return OVER
        if len(self.nodes) >= self._max_nodes and plan in self._by_plan:
            self.is_whole = False
            return self._by_plan[plan]
        number = len(self.nodes)
        self._known[key] = number
        self._by_plan.setdefault(plan, number)
        self.nodes.append(_Node(int(self._region_of[belief > 0].max()), belief, action, plan, reach, {}))
        heapq.heappush(self._waiting, (-reach, number))
        return number

    def _plan(self, belief: Floats) -> tuple[int, int]:
        """The number of the best alpha vector over all regions, and its action; OVER where nothing counts."""
        best, best_value, first = (OVER, 0), -np.inf, 0
        for region in self._vectors.regions:
            weights = belief[region.states]
            if weights.any():
                values = region.values @ weights
                top = int(np.argmax(values))
                if values[top] > best_value:
                    best, best_value = (first + top, int(region.actions[top])), float(values[top])
            first += len(region.actions)
        return best

    def outcomes_of(self, number: int) -> _NodeOutcomes:
        """Returns the outcomes of a finished node."""
        node, matrices = self.nodes[number], self._matrices
        following = np.full(len(self.model.observations), len(self.nodes))
        for observation, target in node.next.items():
            following[observation] = target if target != OVER else len(self.nodes)
        states = self._vectors.regions[node.region].states
        part = matrices.part(node.action)
        inside = self._region_of[matrices.state[part]] == node.region
        return _NodeOutcomes(
            states,
            self.model.rewards[states, node.action],
            self._place_of[matrices.state[part][inside]],
            following[matrices.observation[part][inside]] * len(self.model.states)
            + matrices.after[part][inside],
            matrices.probability[part][inside],
        )


class _Matrices:
    """The outcomes of each action, by observation."""

    def __init__(self, model: ExplicitModel) -> None:
        lengths = np.diff(model.likelihoods.first)[model.sensings]
        elements = np.repeat(np.arange(len(model.sensings)), lengths)
        before = np.r_[0, np.cumsum(lengths)[:-1]]
        places = np.repeat(model.likelihoods.first[model.sensings] - before, lengths)
        places = places + np.arange(len(elements))
        row = model.outcomes.row_numbers[elements]
        self.state, self.action = np.divmod(row, len(model.actions))
        self.after = model.outcomes.numbers[elements]
        self.observation = model.likelihoods.numbers[places]
        self.probability = model.outcomes.probabilities[elements] * model.likelihoods.probabilities[places]
        order = np.argsort(self.action, kind="stable")
        for name in ("state", "action", "after", "observation", "probability"):
            setattr(self, name, getattr(self, name)[order])
        self._first = np.searchsorted(self.action, np.arange(len(model.actions) + 1))

    def part(self, action: int) -> slice:
        """Returns the place of an action's outcomes."""
        return slice(self._first[action], self._first[action + 1])

    def successors(self, belief: Floats, action: int) -> Iterator[tuple[int, Floats]]:
        """Each observation with the weights of the states it leaves."""
        part = self.part(action)
        weights = belief[self.state[part]] * self.probability[part]
        observations = self.observation[part]
        for observation in np.unique(observations[weights > 0]):
            chosen = observations == observation
            after = np.zeros(len(belief))
            np.add.at(after, self.after[part][chosen], weights[chosen])
            yield int(observation), after


class _NodeOutcomes(msgspec.Struct, frozen=True):
    """The outcomes of a node's action from the states of its region: the cells of (node, state) that
    follow."""

    states: Integers
    rewards: Floats
    places: Integers
    cells: Integers
    chances: Floats


def _value(building: _Building, nodes: tuple[GraphNode, ...]) -> float:
    """Returns the value of following the graph, by going over all nodes and states until nothing changes.

    What follows an observation that a node does not expect counts as nothing.
    """
    model = building.model
    state_count = len(model.states)
    # One node more, worth nothing, for missions that are over.
    values = np.zeros((len(nodes) + 1) * state_count)
    outcomes = [building.outcomes_of(number) for number in range(len(nodes))]
    settled = _SETTLED * max(1.0, float(np.abs(model.rewards).max(initial=0)))
    for _ in range(_MAX_SWEEPS):
        change = 0.0
        # Later nodes mostly follow earlier ones.
        for number in reversed(range(len(nodes))):
            node = outcomes[number]
            later = np.bincount(node.places, node.chances * values[node.cells], minlength=len(node.states))
            new = node.rewards + model.discount * later
            cells = number * state_count + node.states
            change = max(change, float(np.abs(new - values[cells]).max(initial=0)))
            values[cells] = new
        if change <= settled:
            break
    by_node = values.reshape(-1, state_count)
    return sum(
        start.weight * float(by_node[node, start.states] @ start.probabilities)
        for start, node in zip(model.starts, building.starts, strict=True)
    )
