"""The memory of a mission: the fold of its journal.

An empty journal folds to the start of a mission, so that starting and taking up are one path.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import msgspec
from msgspec.structs import replace

from aos_protocol import messages
from aos_protocol.errors import StorageError
from aos_protocol.mission_rows import MESSAGES
from aos_runtime.disk.journal import JournalRow
from aos_solver.mission.control.steering import LIFTS, Steering
from aos_solver.mission.records.stretches import Stretch, after
from aos_solver.mission.rules.drift import after_use

_NO_BELIEF = messages.BeliefSummary((), 0.0, 0.0, 0.0, 0, False)


class PastStep(NamedTuple):
    """A step that is over: its decision, the outcome, and when that was observed.

    All decisions but the last have only what their consequences depend on, without the values of actions and
    without the belief: a step of a long mission takes less than 2 kB.
    """

    decision: messages.DecisionRecord
    outcome: messages.Outcome
    observed_ns: int


class Pending(NamedTuple):
    """A step that is not over. Without an `intention` nothing was asked; with an `outcome` all was."""

    decision: messages.DecisionRecord
    intention: messages.Activate | None = None
    outcome: messages.Outcome | None = None


class MissionMemory(msgspec.Struct, frozen=True):
    """The epoch of the newest solver, the steps in order, the step that is not over, the newest state.

    `begun` is the row with which the first solver began the mission, None where none has. `sequence` is the
    number of the next record, and `goal_probability` that of the last one's belief. `mission_parameters` are
    the values that the mission began with. With `is_lifted` somebody has looked after what it held for.
    `drift` are the tests of the model, None where the journal has none. `stretches` are the models in order.
    """

    epoch: int = 0
    steps: tuple[PastStep, ...] = ()
    pending: Pending | None = None
    state: messages.MissionState | None = None
    sequence: int = 0
    goal_probability: float = 0.0
    mission_parameters: dict[str, str] = {}
    begun: messages.MissionBegun | None = None
    steering: Steering = Steering()
    is_lifted: bool = False
    drift: messages.DriftTests | None = None
    stretches: tuple[Stretch, ...] = ()

    @property
    def has_ended(self) -> bool:
        return self.state is not None and self.state.phase == "ended"

    @property
    def is_held(self) -> bool:
        """True where the mission held when its journal broke off."""
        return _is_holding(self.state) and not self.is_lifted


def folded(rows: Iterable[JournalRow]) -> MissionMemory:
    """The memory that a mission's journal holds; StorageError AOS702 for a row that is damaged."""
    epoch, pending, state, sequence, goal_probability = 0, None, None, 0, 0.0
    begun: messages.MissionBegun | None = None
    steps: list[PastStep] = []
    parameters: dict[str, str] = {}
    steering, is_lifted = Steering(), False
    drift: messages.DriftTests | None = None
    stretches: tuple[Stretch, ...] = ()
    for row in rows:
        if row.kind not in MESSAGES:
            continue
        said: Any = row.read_as(MESSAGES[row.kind])
        steering = _steered(steering, said, state)
        if isinstance(said, messages.MissionBegun | messages.ModelAdopted):
            stretches = after(stretches, said, len(steps))
        match said:
            case messages.MissionBegun():
                epoch, parameters, begun = said.epoch, said.mission_parameters, begun or said
            case messages.MissionState():
                is_lifted = is_lifted and _is_holding(said)
                state = said
            case messages.Steer():
                is_lifted = is_lifted or (said.verb in LIFTS and _is_holding(state))
            case messages.DriftTests():
                drift = said
            case messages.DecisionRecord(outcome=None):
                pending = Pending(said)
            case messages.DecisionRecord(outcome=messages.Outcome() as outcome):
                if steps:
                    steps[-1] = steps[-1]._replace(decision=_without_search(steps[-1].decision))
                decision = _of(pending, row).decision
                drift = None if drift is None else after_use(drift, decision, said)
                steps.append(PastStep(decision, outcome, said.stamp_ns))
                pending = None
            case messages.Activate():
                pending = _of(pending, row)._replace(intention=said)
            case messages.Outcome():
                pending = _of(pending, row)._replace(outcome=said)
        if isinstance(said, messages.DecisionRecord):
            sequence, goal_probability = said.sequence + 1, said.belief.goal_probability
    return MissionMemory(
        epoch,
        tuple(steps),
        pending,
        state,
        sequence,
        goal_probability,
        parameters,
        begun,
        steering,
        is_lifted,
        drift,
        stretches,
    )


def _steered(steering: Steering, said: Any, state: messages.MissionState | None) -> Steering:
    """The steering after a row of the journal; `state` is the mission's before it."""
    match said:
        case messages.Steer():
            return steering.after(said, is_holding=_is_holding(state))
        case messages.ActionRefused():
            return steering.refused(said)
        case messages.DecisionRecord(outcome=None):
            return steering.decided(said)
        case messages.DecisionRecord():
            return steering.observed(said)
    return steering


def _is_holding(state: messages.MissionState | None) -> bool:
    return state is not None and state.phase == "holding"


def _without_search(decision: messages.DecisionRecord) -> messages.DecisionRecord:
    return replace(decision, actions=(), predicted=(), belief=_NO_BELIEF, why="", searches=())


def _of(pending: Pending | None, row: JournalRow) -> Pending:
    if pending is None:
        raise StorageError(f"row {row.seq} of the journal, {row.kind}, follows no decision", code="AOS702")
    return pending
