"""The `R:` rules of a `.pomdp` file: the last one that fits counts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import msgspec

__all__ = ["RewardRules"]


class _Rule(msgspec.Struct, frozen=True):
    """A reward for some next states and observations; None is all of them."""

    after: frozenset[int] | None
    observations: frozenset[int] | None
    reward: float

    def fits(self, after: int, observation: int) -> bool:
        return (self.after is None or after in self.after) and (
            self.observations is None or observation in self.observations
        )


class RewardRules:
    """Rules by action and state, in the order of the file."""

    def __init__(self) -> None:
        self._rules: dict[tuple[int, int], list[_Rule]] = {}

    def add(
        self,
        actions: Sequence[int],
        states: Sequence[int],
        after: Sequence[int] | None,
        observations: Sequence[int] | None,
        reward: float,
    ) -> None:
        """A rule that overrides those before it."""
        rule = _Rule(
            None if after is None else frozenset(after),
            None if observations is None else frozenset(observations),
            reward,
        )
        for action in actions:
            for state in states:
                rules = self._rules.setdefault((action, state), [])
                if rule.after is None and rule.observations is None:
                    rules.clear()
                rules.append(rule)

    def expected(
        self,
        action: int,
        state: int,
        transitions: Mapping[int, float],
        sensing: Callable[[int], Mapping[int, float]],
    ) -> float:
        """The expected reward; `sensing` gives the observations of a next state."""
        rules = self._rules.get((action, state), [])
        if not rules:
            return 0.0
        if len(rules) == 1 and rules[0].after is None and rules[0].observations is None:
            return rules[0].reward
        total = 0.0
        for after, probability in transitions.items():
            for observation, chance in sensing(after).items():
                fitting = (rule.reward for rule in reversed(rules) if rule.fits(after, observation))
                total += probability * chance * next(fitting, 0.0)
        return total
