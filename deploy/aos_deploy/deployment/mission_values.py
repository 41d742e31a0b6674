"""Constraints and values of mission parameters: what a mission is given beside its documents.

They come from the deploy file, or an option, and are checked against the project that they are for.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from msgspec.structs import replace

from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlNode
from aos_language.check.constraints import check_constraints
from aos_language.findings import Findings
from aos_language.mission_parameters import OPTION, checked_values, mission_value_of_option, parameter_leaves
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Constraint, MissionValue, Project, Snippet
from aos_protocol.errors import DeployError

_NEVER = "--never"
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
    return Constraint(snippet_of(expression.strip(), Span(_NEVER, 1, column)), probability)


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


SetValues = Annotated[
    list[str] | None,
    typer.Option(OPTION, metavar="NAME=VALUE", help="A mission parameter's value; repeatable"),
]


def values_of_options(texts: Iterable[str] | None) -> tuple[MissionValue, ...]:
    """The values of a command; DocumentError AOS146 for one that is not written `NAME=VALUE`."""
    return tuple(mission_value_of_option(text) for text in texts or ())


def values_of_node(node: YamlNode | None, findings: Findings, file: str) -> tuple[MissionValue, ...]:
    """The values below a key `set`; those of a structure's parts may stand in a mapping."""
    return tuple(_values(node, findings, file, "")) if node is not None else ()


def _values(node: YamlNode, findings: Findings, file: str, name: str) -> Iterator[MissionValue]:
    if isinstance(node, YamlMap):
        for key, item in node.entries.items():
            yield from _values(item, findings, file, f"{name}.{key}" if name else key)
    elif isinstance(node, YamlList):
        findings.error("AOS106", f"set.{name} is a list", node.span, "Give each part of it a value")
    else:
        span = replace(node.text_span, file=file)
        yield MissionValue(name, _text(node.value), span)


def values_of_mapping(values: Mapping[str, Any], where: Span, name: str = "") -> tuple[MissionValue, ...]:
    """The values of a mapping whose places are not known; `where` is the place of all of them."""
    found: list[MissionValue] = []
    for key, value in values.items():
        path = f"{name}.{key}" if name else key
        if isinstance(value, Mapping):
            found += values_of_mapping(value, where, path)
        else:
            found.append(MissionValue(path, _text(value), where))
    return tuple(found)


def _text(value: Any) -> str:
    if value is None:
        return ""
    return str(value).lower() if isinstance(value, bool) else str(value)


def with_values(project: Project, values: Sequence[MissionValue], sources: Iterable[str | Path]) -> Project:
    """The project with the values; DeployError AOS801 with a diagnostic for each that it cannot have.

    `sources` are the files in which they stand.
    """
    findings = findings_of(sources)
    checked_values(values, parameter_leaves(project.environment), findings)
    refuse_errors(findings, "what is set for the mission has errors")
    return replace(project, mission_values=tuple(values))
