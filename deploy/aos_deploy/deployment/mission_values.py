"""The values of mission parameters: from the deploy file, or an option, to the project that they are for."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from msgspec.structs import replace

from aos_deploy.deployment.constraints import findings_of, refuse_errors
from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlNode
from aos_language.findings import Findings
from aos_language.mission_parameters import OPTION, checked_values, mission_value_of_option, parameter_leaves
from aos_protocol.diagnostics import Span
from aos_protocol.documents import MissionValue, Project

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
