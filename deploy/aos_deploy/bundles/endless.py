"""Loops of document code that no draw can end: told as warnings, with a state and how often."""

from aos_language.findings import Findings
from aos_protocol.diagnostics import Diagnostic
from aos_solver.child.engine import Engine

_HINT = (
    "Such a step ends the mission as a failure. Let the loop look first whether it can end, or raise the "
    "penalty of the precondition"
)


async def endless_findings(engine: Engine) -> tuple[Diagnostic, ...]:
    """The loops that had no end in the steps that the engine has made so far."""
    findings = Findings()
    for loop, place in await engine.endless_loops():
        findings.warning("AOS211", loop.text, place, _HINT)
    return findings.diagnostics
