"""Goals and preconditions that nothing leads to, and loops that nothing ends: told as warnings, by looking at
what the actions can do."""

from msgspec.structs import replace

from aos_language.findings import Findings
from aos_protocol.chances import chance_text
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import Environment, Project
from aos_protocol.errors import ModelError, PlanningError
from aos_protocol.messages import BeliefSummary
from aos_solver.building.build import BuiltModel
from aos_solver.child.answers.models import Progress, Reach
from aos_solver.child.engine import Engine
from aos_solver.child.process.engine_child import OverdueError

_NAMED_ACTIONS = 3
_TIME_S = 1.5
_DRAWN_TIME_S = 0.3
MAX_CPU_S = 4.0
"""The processor time of each of the two looks; a place that takes longer is told."""
_ENDLESS_HINT = (
    "Such a step ends the mission as a failure. Let the loop look first whether it can end, or raise the "
    "penalty of the precondition"
)


async def reachability_findings(project: Project, built: BuiltModel) -> tuple[Diagnostic, ...]:
    """Looks at the states that the actions can lead to from the initial belief, for a few seconds at most.

    What is missing is a warning where all states were looked at. Where there are more, a missing goal is a
    remark with the search's extent if that is at least the horizon, and nothing is said of preconditions.
    Loops that never end there are warnings, too. Nothing more is said where the initial belief cannot be
    enumerated. Where not all is looked at, random actions are tried as well. A fault of model code on the way
    is an error at its place, and a look that took too long a remark. Initial states that have ended are told.
    """
    extent = "Looked at no state"

    def tell(progress: Progress) -> None:
        nonlocal extent
        extent = f"Looked at {progress.done} of {progress.all} states that were found"

    try:
        async with await Engine.start(built, seed=1) as engine:
            engine.on_progress = tell
            await engine.tell_progress(0)
            ended = ended_start_findings(project.environment, await engine.summary())
            ended += _without_actions(project, {action.skill for action in engine.description.actions})
            reach = await engine.reach(_TIME_S, MAX_CPU_S)
            extent = _extent(reach)
            if not reach.is_whole:
                await engine.rate(_DRAWN_TIME_S, seed=1, max_seconds=MAX_CPU_S)
            endless = await endless_findings(engine)
    except ModelError as error:
        is_fault = not isinstance(error, OverdueError)
        if is_fault and not error.diagnostics:
            raise
        if not error.diagnostics:
            return (_not_looked_at(project.environment.span, extent),)
        cheaper = f"Make steps cheaper: a search makes many thousand of them. {extent}"
        return tuple(_reached(one, "" if is_fault else cheaper) for one in error.diagnostics)
    if reach.states == 0:
        return (*ended, *endless)
    findings = Findings()
    is_whole = not reach.limit
    goal = _goal_span(project.environment)
    if goal is not None and not reach.has_goal:
        if is_whole:
            findings.warning("AOS132", "no action leads to a goal", goal, _extent(reach))
        elif reach.depth >= project.environment.horizon:
            findings.remark("AOS132", "no goal was found", goal, _extent(reach))
    for skill in project.skills if is_whole else ():
        actions = [action for action in reach.actions if action.skill == skill.name]
        unmet = [action.name for action in actions if not action.is_met]
        if unmet and skill.model.precondition:
            message = f"the precondition of {_named(unmet, len(actions), skill.name)} is never met"
            findings.warning("AOS131", message, skill.model.precondition[0].span, _extent(reach))
    return (*ended, *endless, *findings.diagnostics)


def _without_actions(project: Project, used: set[str]) -> tuple[Diagnostic, ...]:
    """The skills whose lists of parameters are empty."""
    findings = Findings()
    for model in (skill.model for skill in project.skills if skill.name not in used):
        place = model.possible_parameters[0].span if model.possible_parameters else model.span
        hint = "Its list is made once, from the variables' defaults"
        findings.warning("AOS119", f"{model.name} has no grounded action", place, hint)
    return findings.diagnostics


def _not_looked_at(place: Span, extent: str) -> Diagnostic:
    """A search that ended for its time in no code of the documents."""
    message = f"the search for what the actions lead to has ended: it took more than {MAX_CPU_S:g} s"
    hint = (
        f"{extent}. Nothing is told of goals and preconditions that nothing leads to, nor of faults behind it"
    )
    return Diagnostic(Severity.REMARK, "AOS132", message, place, hint)


def _reached(diagnostic: Diagnostic, cheaper: str) -> Diagnostic:
    """A fault is an error. What only takes too long to look at everything is a warning, with its own hint."""
    severity = Severity.WARNING if cheaper else Severity.ERROR
    message = f"in a state that can be reached: {diagnostic.message}"
    return replace(diagnostic, severity=severity, message=message, hint=cheaper or diagnostic.hint)


def _goal_span(environment: Environment) -> Span | None:
    """The first special state that may be a goal."""
    for special in environment.special_states:
        code = " ".join(part.code.code for part in special.code if part.code is not None)
        is_goal = special.is_goal and not special.is_failure
        if (is_goal and (special.is_failure is False or special.reward > 0)) or "__isGoalState" in code:
            return special.span
    return None


def _named(unmet: list[str], actions: int, skill: str) -> str:
    if len(unmet) == actions:
        return skill
    rest = len(unmet) - _NAMED_ACTIONS
    return ", ".join(unmet[:_NAMED_ACTIONS]) + (f" and {rest} more" if rest > 0 else "")


def _extent(reach: Reach) -> str:
    states = "1 state" if reach.states == 1 else f"{reach.states} states"
    if reach.limit:
        return f"Looked at {states}, up to {reach.depth} actions from the start; {reach.limit}"
    return f"Looked at all that can be reached, {states}, up to {reach.depth} actions from the start"


async def endless_findings(engine: Engine) -> tuple[Diagnostic, ...]:
    """The loops that had no end in the steps that the engine has made so far."""
    findings = Findings()
    for loop, place in await engine.endless_loops():
        findings.warning("AOS211", loop.text, place, _ENDLESS_HINT)
    return findings.diagnostics


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
