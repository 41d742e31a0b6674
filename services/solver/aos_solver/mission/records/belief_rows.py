"""Whole beliefs in the journal, so that what was believed can be looked at without a replay."""

from aos_protocol.messages import BeliefRow, BeliefSummary
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
        row = BeliefRow(step, model.digest, beliefs.beliefs, beliefs.words, belief.digest)
        record.journal(BELIEF, row)
