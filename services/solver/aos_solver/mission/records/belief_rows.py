"""Whole beliefs in the journal, so that what was believed can be looked at without a replay."""

from aos_protocol.messages import BeliefRow, BeliefSummary, WeightedStates
from aos_solver.child.answers.beliefs import ExportedBelief, ExportedBeliefs
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import Record

BELIEF = "belief"
"""The kind of the journal's rows."""

SMALL_BYTES = 64 * 1024
"""A belief of this size is kept after every step."""
LARGE_EVERY = 20
"""A larger one is kept each time that so many steps are over."""
MOST_BYTES = 8 * 2**20
"""The largest belief that is kept at all."""


async def keep_belief(record: Record, model: RunningModel, step: int, belief: BeliefSummary) -> None:
    """Journals what is believed after a step, as far as its size allows."""
    if not record.keeps_beliefs:
        return
    most_bytes = SMALL_BYTES if step % LARGE_EVERY else MOST_BYTES
    beliefs = await model.engine.export_beliefs_within(most_bytes)
    if beliefs is not None:
        rows = tuple(_row_of(each) for each in beliefs.beliefs)
        record.journal(BELIEF, BeliefRow(step, model.digest, rows, beliefs.words, belief.digest))


def exported_of(row: BeliefRow) -> ExportedBeliefs:
    """The beliefs of a row, for an engine whose states have the layout of the row's model."""
    return ExportedBeliefs(row.words, tuple(_exported_of(states) for states in row.beliefs))


def _row_of(belief: ExportedBelief) -> WeightedStates:
    return WeightedStates(
        belief.particles, belief.constants, belief.error_bound, belief.is_drawn, belief.history
    )


def _exported_of(states: WeightedStates) -> ExportedBelief:
    return ExportedBelief(
        states.error_bound,
        states.is_drawn,
        len(states.particles),
        states.constants,
        states.history,
        states.particles,
    )
