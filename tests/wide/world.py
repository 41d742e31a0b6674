"""A problem played without the engine: the world of a rule by hand, and of random actions."""

import random
from abc import ABC, abstractmethod

MOST_STEPS = 120  # in a mission


class World(ABC):
    """The hidden state of a problem, and what was earned in it so far."""

    def __init__(self, rng: random.Random, discount: float, **actions: int):
        """Has for each skill of `actions` so many values of its parameter, from 0."""
        self.rng = rng
        self.discount = discount
        self.actions = [(skill, value) for skill, count in actions.items() for value in range(count)]
        self.earned = 0.0
        self.steps = 0
        self.has_ended = False

    @property
    def is_over(self) -> bool:
        return self.has_ended or self.steps >= MOST_STEPS

    @abstractmethod
    def act(self, skill: str, value: int = 0) -> str:
        """Takes an action and returns what is reported."""

    def gain(self, reward: float):
        self.earned += self.discount**self.steps * reward
        self.steps += 1

    def play_at_random(self) -> float:
        while not self.is_over:
            self.act(*self.rng.choice(self.actions))
        return self.earned
