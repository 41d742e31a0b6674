"""The `R:` rules of a `.pomdp` file: the last one that fits counts."""

from collections.abc import Callable, Mapping

Choice = int | None
"""A number, or None for all."""
Tail = tuple[Choice, Choice]
"""A next state and an observation."""


class RewardRules:
    """Rules by what they are for. A rule for all of a kind is one entry, however many that are."""

    def __init__(self) -> None:
        self._rules: dict[tuple[Choice, Choice], dict[Tail, tuple[int, float]]] = {}
        self._count = 0

    def add(self, action: Choice, state: Choice, after: Choice, observation: Choice, reward: float) -> None:
        """A rule that overrides those before it."""
        self._count += 1
        self._rules.setdefault((action, state), {})[after, observation] = self._count, reward

    def expected(
        self,
        action: int,
        state: int,
        transitions: Mapping[int, float],
        sensing: Callable[[int], Mapping[int, float]],
    ) -> float:
        """The expected reward; `sensing` gives the observations of a next state."""
        heads = ((action, state), (action, None), (None, state), (None, None))
        tables = [self._rules[head] for head in heads if head in self._rules]
        plain = max((table[None, None] for table in tables if (None, None) in table), default=(0, 0.0))
        tables = [table for table in tables if len(table) > ((None, None) in table)]
        if not tables:
            return plain[1]
        total = 0.0
        for after, probability in transitions.items():
            for observation, chance in sensing(after).items():
                tails = ((after, observation), (after, None), (None, observation))
                fitting = (table[tail] for table in tables for tail in tails if tail in table)
                total += probability * chance * max((plain, *fitting))[1]
        return total
