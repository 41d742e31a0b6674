from typing import Any

from aos_protocol.messages import BeliefSummary, DecisionRecord


def decision_record(sequence: int, mission: str = "m", skill: str = "look", **others: Any) -> DecisionRecord:
    """The record with this number: of a decision where it is even, of what came of it where it is odd."""
    usual: dict[str, Any] = {
        "stamp_ns": 0,
        "epoch": 1,
        "step": sequence // 2 + 1,
        "action": skill,
        "parameters": {},
        "model_digest": "d",
        "revision": 1,
        "seed": 1,
        "simulations": 1,
        "horizon": 1,
        "planning_s": 0.0,
        "actions": (),
        "predicted": (),
        "belief": BeliefSummary((), 0.0, 0.0, 0.0, 1, True),
    }
    return DecisionRecord(sequence=sequence, mission=mission, skill=skill, **usual | others)
