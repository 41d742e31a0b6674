"""The mission's constraints: from the deploy file, or an option, to the project that they are about.

Findings about what stands in a deploy file or an option, and their refusal, are made here for both.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path

from msgspec.structs import replace

from aos_language.check.constraints import check_constraints
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Constraint, Project, Snippet
from aos_protocol.errors import DeployError

OPTION = "--never"
"""Constraints are written `PROBABILITY: EXPRESSION` there; it is also the place of what is wrong with one."""

MAX_CONSTRAINTS = 32


def snippet_of(text: str, span: Span, *, is_block: bool = False) -> Snippet:
    """The expression of a deploy file, which starts at `span`; a `block` in YAML at the next line."""
    origins = [
        Span(span.file, span.line + number + is_block, span.column if number == 0 and not is_block else 1)
        for number in range(text.count("\n") + 1)
    ]
    return Snippet(text, tuple(origins))


def constraint_of_option(text: str) -> Constraint:
    """`0.01: serve && state.is_out`; DeployError AOS801 if it is not written so."""
    number, _, expression = text.partition(":")
    try:
        probability = float(number)
    except ValueError:
        probability = -1.0
    if not 0 <= probability < 1 or not expression.strip():
        hint = "Write it as --never '0.01: serve && state.arm_outstretched'"
        raise DeployError(f"{text!r} is no constraint", hint=hint)
    column = len(text) - len(expression.lstrip()) + 1
    return Constraint(snippet_of(expression.strip(), Span(OPTION, 1, column)), probability)


def constrained(
    project: Project, constraints: Sequence[Constraint], sources: Iterable[str | Path] = ()
) -> Project:
    """The project with the constraints; DeployError AOS801 with a diagnostic for each mistake in them.

    `sources` are the files in which they stand.
    """
    findings = findings_of(sources)
    check_constraints(constraints, project, findings)
    if len(constraints) > MAX_CONSTRAINTS:
        where = constraints[MAX_CONSTRAINTS].never.span
        findings.error("AOS142", f"more than {MAX_CONSTRAINTS} constraints", where, "Join some of them by ||")
    refuse_errors(findings, "the mission's constraints have errors")
    return replace(project, constraints=tuple(constraints))


def findings_of(sources: Iterable[str | Path]) -> Findings:
    """Findings that show the lines of these files."""
    findings = Findings()
    for source in sources:
        findings.add_source(str(source), Path(source).read_text(encoding="utf-8").splitlines())
    return findings


def refuse_errors(findings: Findings, message: str) -> None:
    """Raises DeployError AOS801 with all findings where one is an error."""
    if findings.has_errors:
        raise DeployError(message, diagnostics=findings.sorted())
