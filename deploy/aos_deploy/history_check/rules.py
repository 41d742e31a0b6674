"""The rules that every history of a run has to hold to, and their violations."""

import msgspec

RULES = {
    "rows": "the rows of each file are numbered from 1 without a gap, and each can be read",
    "sequence": "the sequence numbers of the decision records count from 0 without a gap",
    "steps": "decisions and observations take turns, of the same action, and steps count from 1",
    "belief": "a decision is made with the belief of the observed record before it",
    "replay": "a replay of the outcomes gives each belief again, by its digest",
    "epochs": "the epoch of a mission goes up by one with each solver, and never falls",
    "intention": "an intention is that of the decision before it",
    "outcome": "an outcome belongs to the intention before it, and is the one that the middleware has stored",
    "id": "an id stands for one skill with its parameters, and nothing moves that was not intended",
    "motion": "an id moves at most once",
    "ends": "what ends was started before, and ends once",
    "hold": "nothing starts while the mission holds",
    "steering": "while somebody holds the mission nothing is decided but what was asked for, and nothing is "
    "decided for that is left out",
    "over": "nothing follows the end of the mission",
    "verdict": "the summary has the verdict of the journal, as far as that goes",
}
"""Each rule by its name."""
BY_TIME = ("hold", "over")
"""The rules by which times of a ledger are compared with those of a journal."""


class Violation(msgspec.Struct, frozen=True):
    """A row that breaks a rule: `file` is its name in the run directory, `row` its number, 0 for the file."""

    rule: str
    file: str
    row: int
    text: str
