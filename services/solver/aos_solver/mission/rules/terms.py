"""The terms that a mission is run on."""

import msgspec

from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules


class Terms(msgspec.Struct, frozen=True, kw_only=True):
    """The terms of a mission: its name, what ends it, how decisions are made, and what failures lead to.

    An activation whose skill's rule gives no time has `activation_timeout_s`. A mission that nothing can be
    run in holds for `hold_s` at most. Without `is_cautious` no decision is taken for the cautious belief.
    """

    name: str
    search: Search
    epoch: int = 1
    limits: MissionLimits = MissionLimits()
    failures: FailureRules = FailureRules()
    activation_timeout_s: float = 120.0
    hold_s: float = 600.0
    is_cautious: bool = True
