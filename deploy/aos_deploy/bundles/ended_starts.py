"""Initial states in which the mission is over: special states are looked at before the first step, too."""

from aos_language.findings import Findings
from aos_protocol.chances import chance_text
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Environment
from aos_protocol.errors import PlanningError
from aos_protocol.messages import BeliefSummary

_ROUNDING = 1e-9
_HINT = (
    "Endings are looked at before the first step, too, and an ended state earns nothing. Change the "
    "condition, or where the state begins"
)


def ended_start_findings(environment: Environment, belief: BeliefSummary) -> tuple[Diagnostic, ...]:
    """Returns a warning where all initial states have ended, and a remark where some have."""
    findings = Findings()
    ended = _ended(belief)
    if ended and environment.special_states:
        tell = findings.warning if _is_over(belief) else findings.remark
        tell("AOS150", _text(belief), environment.special_states[0].span, _HINT)
    return findings.diagnostics


def remark_on_start(belief: BeliefSummary) -> str:
    """Returns what is told of ended states in the belief before a first decision, "" where there are none.

    PlanningError AOS302 where there are no others, so that nothing is left to decide.
    """
    if _is_over(belief):
        raise PlanningError(_text(belief), hint=_HINT)
    return _text(belief) if _ended(belief) else ""


def _is_over(belief: BeliefSummary) -> bool:
    return sum(chance for _, chance in _ended(belief)) > 1 - _ROUNDING


def _ended(belief: BeliefSummary) -> list[tuple[str, float]]:
    endings = (
        ("goal", belief.goal_probability),
        ("over", belief.over_probability),
        ("failure", belief.failure_probability),
    )
    return [(name, chance) for name, chance in endings if chance > _ROUNDING]


def _text(belief: BeliefSummary) -> str:
    endings = ", ".join(f"{name} with probability {chance_text(chance)}" for name, chance in _ended(belief))
    return f"the mission has ended before its first step: {endings}"
