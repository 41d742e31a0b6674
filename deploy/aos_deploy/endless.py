"""Loops of document code that no draw can end: told as warnings, with a state and how often."""

from aos_deploy.printing import count
from aos_language.findings import Findings
from aos_protocol.diagnostics import Diagnostic
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers import EndlessLoop
from aos_solver.child.engine import Engine

_HINT = (
    "Such a step ends the mission as a failure. Let the loop look first whether it can end, or raise the "
    "penalty of the precondition"
)


async def endless_findings(built: BuiltModel, engine: Engine) -> tuple[Diagnostic, ...]:
    """The loops that had no end in the steps that the engine has made so far."""
    findings = Findings()
    for loop in (await engine.endless_steps()).loops:
        if (span := built.emitted.place_of_loop(loop.loop)) is not None:
            findings.warning("AOS211", _never_ends(loop), span, _HINT)
    return findings.diagnostics


def _never_ends(loop: EndlessLoop) -> str:
    return (
        f"this loop never ends in {count(loop.steps, 'simulated step')}, the first of them with {loop.state}"
    )
