"""Faults that a simulator cannot produce, drawn from the mission's seed and kept for the record."""

import random


class Faults:
    """`drawn` holds the faults of the current call; `noise` is the source of perception's errors.

    Faults and noise have generators of their own, so that one more fault in a model does not shift the noise.
    """

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(f"faults {seed}")
        self.noise = random.Random(f"perception {seed}")
        self.drawn: list[str] = []

    def draw(self, fault: str, probability: float) -> bool:
        """Draws whether a fault happens now."""
        happens = self._chance.random() < probability
        if happens:
            self.drawn.append(fault)
        return happens
