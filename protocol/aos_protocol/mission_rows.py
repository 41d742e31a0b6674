"""The rows of a mission's journal: their kinds, and the message that each kind holds.

Those are the rows of which a mission is taken up. Whole beliefs are there for who looks at them.
"""

from typing import Final

from aos_protocol import messages

BEGUN: Final = "begun"
"""A solver begins, or takes up, the mission."""
ADOPTED: Final = "adopted"
"""Another model is decided with from here on."""
DECISION: Final = "decision"
"""An action was chosen, or its outcome was learned from."""
INTENDED: Final = "intended"
"""A skill is about to be asked for."""
OUTCOME: Final = "outcome"
"""An activation ended."""
STATE: Final = "mission"
"""The mission's phase, or what is said of it, has changed."""
STEERED: Final = "steered"
"""Somebody steers."""
REFUSED: Final = "refused"
"""An action was asked for and is not carried out."""
DRIFT: Final = "drift"
"""The tests of a model begin, or go over to another mission."""
MESSAGES: dict[str, type[messages.Message]] = {
    BEGUN: messages.MissionBegun,
    ADOPTED: messages.ModelAdopted,
    DECISION: messages.DecisionRecord,
    INTENDED: messages.Activate,
    OUTCOME: messages.Outcome,
    STATE: messages.MissionState,
    STEERED: messages.Steer,
    REFUSED: messages.ActionRefused,
    DRIFT: messages.DriftTests,
}
