"""The constraints of a mission: does each say something about states and actions that the project has?"""

from __future__ import annotations

from collections.abc import Iterable

from aos_language.assembly import Assembly
from aos_language.check.blocks import Block, Role
from aos_language.check.model_code import check_block
from aos_language.check.scope import STATE_COPIES, Scope
from aos_language.cpp.snippets import Access, Cpp, read_cpp_expression, strip_comments
from aos_language.findings import Findings
from aos_protocol.documents import Constraint, Project, Snippet

__all__ = ["check_constraints"]

CONSTRAINT = Role("a constraint", ("state", "state__"), sees_chosen_action=True)

_LANGUAGE = frozenset({"NULL", "false", "nullptr", "std", "true"})
_DRAWS = frozenset({"AOS", "AOSUtils"})


def check_constraints(constraints: Iterable[Constraint], project: Project, findings: Findings) -> None:
    """Reports what a constraint names and the project does not have, and constraints that decide nothing."""
    models = {skill.name: skill.model for skill in project.skills}
    mappings = {skill.name: skill.mapping for skill in project.skills}
    scope = Scope.of(Assembly(project.environment, models, mappings, project.low_level))
    for constraint in constraints:
        cpp = read_cpp_expression(constraint.never.code)
        before = len(findings)
        _check_expression(constraint.never, findings)
        if len(findings) > before:
            continue
        _check_names(cpp, constraint.never, scope, findings)
        if len(findings) == before:
            check_block(Block(CONSTRAINT, constraint.never, is_expression=True), scope, findings)
        if len(findings) == before and not _is_about_something(cpp, scope):
            hint = "Write it over `state`, `state__` and the names of skills, as `serve && state.is_out`"
            message = "a constraint that neither a state nor an action decides"
            findings.error("AOS142", message, constraint.never.span, hint)


def _check_expression(snippet: Snippet, findings: Findings) -> None:
    """Statements are none: what stands behind a semicolon would be read as nothing."""
    code, depth = strip_comments(snippet.code), 0
    for offset, character in enumerate(code):
        depth += (character in "([{") - (character in ")]}")
        if character == ";" and depth == 0:
            line = code.count("\n", 0, offset) + 1
            span = snippet.locate(line, offset - code.rfind("\n", 0, offset))
            findings.error("AOS108", "a constraint is one expression", span, "Join conditions by && and ||")
            return


def _check_names(cpp: Cpp, snippet: Snippet, scope: Scope, findings: Findings) -> None:
    """Names that stand first: in an expression on its own nothing else could have declared them."""
    own = {declaration.name for declaration in cpp.declarations}
    own |= {*scope.enums, *scope.enum_values, *scope.compounds, *scope.low_level_names}
    for mention in cpp.mentions:
        name = mention.path[0]
        if name in own or name in _LANGUAGE or name in scope.skills or name in STATE_COPIES:
            continue
        span = snippet.locate(mention.root.line, mention.root.column)
        if name in _DRAWS:
            hint = "Name the state that the draw leads to, as `state__.is_out`"
            findings.error("AOS142", "a constraint that draws at random", span, hint)
        elif mention.access is not Access.CALL:
            known = ("state", "state__", *scope.skills, *scope.enum_values)
            findings.unknown(name, known, f"unknown name `{name}`", span, "It may name skills and states")


def _is_about_something(cpp: Cpp, scope: Scope) -> bool:
    return any(mention.path[0] in {*STATE_COPIES, *scope.skills} for mention in cpp.mentions)
