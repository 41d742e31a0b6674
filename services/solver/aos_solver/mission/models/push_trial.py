"""The trial of documents that are pushed into a mission: random actions, and a decision."""

from msgspec.structs import replace

from aos_language.check.endings import may_be_goal
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Environment
from aos_protocol.errors import ModelError
from aos_solver.child.engine import Engine

_TRIED_S = 0.1
_TRIED_CPU_S = 4.0
"""One step of a model that takes so much processor time does not end, for all that a mission can wait."""
_TRIED_SIMULATIONS = 20
_STEP_CPU_S = 0.1
"""A decision makes hundreds of steps at least, and ends the mission where it takes 120 s."""


async def faults_in_trial(engine: Engine, environment: Span) -> tuple[Diagnostic, ...]:
    """Returns the faults of code that fails, does not end or takes long, which would end the mission.

    `environment` is the place of what has no other one.
    """
    try:
        tried = await engine.rate(_TRIED_S, seed=1, max_seconds=_TRIED_CPU_S)
        if (step_s := tried.cpu_seconds / max(tried.samples, 1)) >= _STEP_CPU_S:
            return (await _slow(engine, step_s, environment),)
        # What a decision tells has to be readable.
        await engine.plan(seed=1, simulations=_TRIED_SIMULATIONS, planner="pomcp")
    except ModelError as error:
        return tuple(map(_reached, error.diagnostics)) or (
            Diagnostic(Severity.ERROR, error.code, error.message, environment, error.hint),
        )
    return ()


async def goal_out_of_reach(engine: Engine, environment: Environment) -> tuple[Diagnostic, ...]:
    """Warns where actions lead to none of the goals, as far as is seen in a second."""
    goals = [special.span for special in environment.special_states if may_be_goal(special)]
    if not goals or (await engine.may_reach_goal()).is_reachable:
        return ()
    message = "a mission runs, and with these documents no way to a goal is found"
    hint = "Push a skill that leads to one, or end the mission"
    return (Diagnostic(Severity.WARNING, "AOS132", message, goals[0], hint),)


async def _slow(engine: Engine, step_s: float, environment: Span) -> Diagnostic:
    code = await engine.slow_code()
    where = "no one place of it takes half of that" if code is None else f"{code.share:.0%} of that here"
    message = f"a step takes {step_s:.1f} s of processor time, {where}, and a decision makes hundreds"
    span = environment if code is None else code.span
    return Diagnostic(Severity.ERROR, "AOS211", message, span, "Compute less in a step, and print less")


def _reached(found: Diagnostic) -> Diagnostic:
    return replace(found, message=f"in a state that can be reached: {found.message}")
