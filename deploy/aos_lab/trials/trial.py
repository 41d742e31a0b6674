"""One mission that was run for its record: what was done, what came back, how it ended."""

import json
from collections.abc import Iterator
from pathlib import Path

import msgspec

from aos_protocol.codec import UNREADABLE

NOTHING_OBSERVED = "no observation"
"""The text in a step that brought none; no response has a space."""


class Trial(msgspec.Struct, frozen=True, kw_only=True):
    """A mission of one seed.

    `ending` is why it stopped. `goal` says whether the goal was reached: in the model's world where the model
    played it, else as the last belief has it, since nobody tells a robot. A response is empty where an
    activation brought no observation. `states` are texts of the world's truth after each action, where it is
    known; one of a simulated world names its step. `world_ending` is how a model's world has ended, or empty.
    `value` is the discounted return, which only a model counts. A mission that broke has its `fault`.
    `mission_parameters` are the values of all parts of mission parameters.
    """

    seed: int
    ending: str
    goal: bool
    actions: tuple[str, ...] = ()
    responses: tuple[str, ...] = ()
    states: tuple[str, ...] = ()
    world_ending: str = ""
    value: float | None = None
    seconds: float = 0.0
    fault: str = ""
    mission_parameters: dict[str, str] = {}

    @property
    def steps(self) -> list[str]:
        """Each action with what came back, as `pick > success`, or `pick > no observation`."""
        return [
            f"{action} > {response or NOTHING_OBSERVED}"
            for action, response in zip(self.actions, self.responses, strict=True)
        ]

    @property
    def truths(self) -> dict[int, str]:
        """The states by the number of their step, from 1; a model's last one says how its world has ended."""
        states = {_step_of(state, number): state for number, state in enumerate(self.states, 1)}
        if states and self.world_ending:
            last = max(states)
            states[last] += f", world_ending={self.world_ending}"
        return states


def _step_of(state: str, number: int) -> int:
    """A call that never came to a simulated world has left no line there."""
    if not state.startswith("{"):
        return number
    step: int = json.loads(state).get("step", number)
    return step


class KeptTrial(msgspec.Struct, frozen=True):
    """One line of the file of records, with the digest of what the mission was run with."""

    digest: str
    trial: Trial


def kept_trials(records: Path) -> Iterator[KeptTrial]:
    """Yields the missions of a file of records that did not break; a line that was cut short is left out."""
    for line in records.read_bytes().splitlines():
        try:
            kept = msgspec.json.decode(line, type=KeptTrial)
        except UNREADABLE:
            continue
        if not kept.trial.fault:
            yield kept


def truth_lines(run: Path) -> list[str]:
    """The lines in which a run's simulated world, or the model that played it, tells its truth."""
    lines: list[str] = []
    for name in ("world.jsonl", "model.jsonl"):
        if (run / name).is_file():
            with (run / name).open() as file:
                lines += map(str.strip, file)
    return lines
