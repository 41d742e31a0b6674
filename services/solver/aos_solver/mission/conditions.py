"""Conditions on a state, as people write them when they start a mission: `state.robot_at == Kitchen`.

They are expressions of the documents' language. They are checked and compiled as the mission's constraints
are, into a model of their own, and run in the same sandbox. That model's constraints are the conditions: see
`Engine.condition`.
"""

from collections.abc import Sequence
from pathlib import Path

from msgspec.structs import replace

from aos_language.check.constraints import check_conditions
from aos_language.findings import Findings
from aos_protocol.diagnostics import Diagnostic, Span
from aos_protocol.documents import Constraint, Project, Snippet
from aos_protocol.errors import AosError, DocumentError, ModelError
from aos_solver.building.build import BuiltModel
from aos_solver.building.project_build import build_project

OPTION = "--given"
"""The place of what is wrong with a condition. Its line is the number of the condition."""

MAX_CONDITIONS = 16


async def built_with_conditions(project: Project, given: Sequence[str], cache_dir: Path) -> BuiltModel:
    """The model of a project whose constraints are the conditions.

    DocumentError with a diagnostic for each mistake in them.
    """
    lines = [" ".join(text.split("\n")).strip() for text in given]
    findings = Findings({OPTION: lines})
    if len(lines) > MAX_CONDITIONS:
        message = f"more than {MAX_CONDITIONS} conditions"
        findings.error("AOS142", message, Span(OPTION, MAX_CONDITIONS + 1, 1), "Join some of them by &&")
    snippets = [Snippet(line, (Span(OPTION, number, 1),)) for number, line in enumerate(lines, 1)]
    for line, snippet in zip(lines, snippets, strict=True):
        if not line:
            findings.error("AOS142", "an empty condition", snippet.span, "Write it over `state`")
    if not findings.has_errors:
        check_conditions(snippets, project, findings)
    if findings.has_errors:
        raise _refused(findings.sorted())
    constraints = tuple(Constraint(snippet, 0.0) for snippet in snippets)
    conditioned = replace(project, constraints=constraints)
    try:
        return await build_project(conditioned, cache_dir)
    except ModelError as error:
        own = [found for found in error.diagnostics if found.span.file == OPTION]
        if not own:
            raise
        for found in own:
            findings.add(found)
        raise _refused(findings.sorted()) from error


def _refused(diagnostics: tuple[Diagnostic, ...]) -> AosError:
    first = diagnostics[0]
    message = f"what is given has errors: {first.message} ({first.span})"
    return DocumentError(message, code=first.code, hint=first.hint, diagnostics=diagnostics)
