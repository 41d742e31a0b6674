"""The constraints of a mission, and the conditions that it begins with: what they may say.

A constraint speaks of states and actions that the project has, a condition of the state that there is.
"""

from collections.abc import Iterable, Sequence

from aos_language.assembly import Assembly
from aos_language.check.models.blocks import Block, Role
from aos_language.check.models.model_code import check_block
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.snippets import Access, Cpp, read_cpp_expression, strip_comments
from aos_language.findings import Findings
from aos_protocol.documents import Constraint, Project, Snippet

CONSTRAINT = Role("a constraint", ("state", "state__"), sees_chosen_action=True)
CONDITION = Role("a condition", ("state",))

_LANGUAGE = frozenset({"NULL", "false", "nullptr", "std", "true"})


def check_constraints(constraints: Iterable[Constraint], project: Project, findings: Findings) -> None:
    """Reports what a constraint names and the project does not have, and constraints that decide nothing."""
    scope = _scope_of(project)
    names = (*STATES, *scope.skills)
    hint = "Write it over `state`, `state__` and the names of skills, as `serve && state.is_out`"
    for constraint in constraints:
        cpp = _checked(constraint.never, CONSTRAINT, names, scope, findings)
        if cpp is not None and not _names_any(cpp, names):
            message = "a constraint that neither a state nor an action decides"
            findings.error("AOS142", message, constraint.never.span, hint)


def check_conditions(conditions: Iterable[Snippet], project: Project, findings: Findings) -> None:
    """Reports what a condition names and the project does not have, and conditions that no state decides."""
    scope = _scope_of(project)
    for condition in conditions:
        cpp = _checked(condition, CONDITION, ("state",), scope, findings)
        if cpp is not None and not _names_any(cpp, ("state",)):
            hint = "Write it over `state`, as `state.robot_at == Kitchen`"
            findings.error("AOS142", "a condition that no state decides", condition.span, hint)


def _scope_of(project: Project) -> Scope:
    models = {skill.name: skill.model for skill in project.skills}
    mappings = {skill.name: skill.mapping for skill in project.skills}
    return Scope.of(Assembly(project.environment, models, mappings, low_level=project.low_level))


def _checked(
    snippet: Snippet, role: Role, names: Sequence[str], scope: Scope, findings: Findings
) -> Cpp | None:
    """The expression as it is read; None where something is wrong with it. It may begin with these names."""
    cpp = read_cpp_expression(snippet.code)
    before = len(findings)
    _check_expression(snippet, role, findings)
    if len(findings) == before:
        _check_names(cpp, snippet, role, names, scope, findings)
    if len(findings) == before:
        check_block(Block(role, snippet, is_expression=True), scope, findings)
    return cpp if len(findings) == before else None


def _check_expression(snippet: Snippet, role: Role, findings: Findings) -> None:
    """Statements are none: what stands behind a semicolon would be read as nothing."""
    code, depth = strip_comments(snippet.code), 0
    for offset, character in enumerate(code):
        depth += (character in "([{") - (character in ")]}")
        if character == ";" and depth == 0:
            span = snippet.at(offset)
            findings.error("AOS108", f"{role.title} is one expression", span, "Join conditions by && and ||")
            return


def _check_names(
    cpp: Cpp, snippet: Snippet, role: Role, names: Sequence[str], scope: Scope, findings: Findings
) -> None:
    """Names that stand first: in an expression on its own nothing else could have declared them."""
    own = cpp.declared
    own |= {*scope.enums, *scope.enum_values, *scope.compounds, *scope.low_level_names}
    for mention in cpp.mentions:
        name = mention.path[0]
        if name in own or name in _LANGUAGE or name in names:
            continue
        span = snippet.at(mention.root.start)
        if name in DRAW_SOURCES:
            hint = "Name the state that the draw leads to, as `state__.is_out`"
            findings.error("AOS142", f"{role.title} that draws at random", span, hint)
        elif mention.access is not Access.CALL:
            known = (*(each for each in names if each not in ("state_", "state___")), *scope.enum_values)
            otherwise = f"It may name {'skills and ' if role is CONSTRAINT else ''}states"
            findings.unknown(name, known, f"unknown name `{name}`", span, otherwise)


def _names_any(cpp: Cpp, names: Sequence[str]) -> bool:
    return any(mention.path[0] in names for mention in cpp.mentions)
