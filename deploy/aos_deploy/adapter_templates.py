"""An adapter to start from, made for a bundle: a deploy file, and a program that serves its paths."""

from __future__ import annotations

import re
from importlib.resources import files
from pprint import pformat
from string import Template
from typing import Any

from aos_protocol.codec import PROTOCOL_VERSION
from aos_protocol.documents import AbstractionMapping, LocalSource, Project

__all__ = ["KINDS", "adapter_files"]

KINDS = ("model", "python", "command", "external", "class")

_FIELD = re.compile(r"\b__input\.([A-Za-z_]\w*)")
_EXAMPLES: dict[str, Any] = {"bool": True, "int": 0, "float": 0.0, "double": 0.0, "string": "", "str": ""}


def adapter_files(kind: str, project: Project, bundle: str) -> dict[str, str]:
    """The files by name. `bundle` is the way from the deploy file to the bundle."""
    name = project.name
    program = f"{name}_robot.py"
    mappings = {"/" + skill.mapping.activation.path.strip("/"): skill.mapping for skill in project.skills}
    results = {path: _result(mapping) for path, mapping in mappings.items()}
    values = {
        "robot": name,
        "file": program,
        "version": PROTOCOL_VERSION,
        "paths": pformat(list(mappings), width=100),
        "results": pformat(results, width=100, sort_dicts=False),
        "functions": "".join(_function(path, mapping) for path, mapping in mappings.items()),
    }
    made = {f"{name}.yaml": _deploy_file(kind, project, bundle, program, list(mappings))}
    template = {"python": "python", "class": "class"}.get(kind, "program")
    if kind != "model":
        source = files("aos_deploy") / "templates" / "adapter" / f"{template}.py.template"
        made[program] = Template(source.read_text("utf-8")).substitute(values)
    return made


def _deploy_file(kind: str, project: Project, bundle: str, program: str, paths: list[str]) -> str:
    name = project.name
    lines = [
        f"# The robot {name}: what runs when aos-up starts it. Every key: docs/deploy-file.md.",
        "aos: 1",
        f"robot: {name}",
        f"bundles: [{bundle}]",
        "mission: {goal_probability: 0.9, step_limit: 30}",
        "solver: {simulations: 10_000, seed: 1}",
    ]
    if kind == "command":
        lines += ["adapters:", f"  robot: {{command: [python, {program}]}}"]
    elif kind == "external":
        lines += ["adapters:", "  robot: external"]
    elif kind == "class":
        lines += ["adapters:", f"  robot: {{class: '{program.removesuffix('.py')}:Robot'}}"]
    lines.append("bind:")
    if kind == "model":
        lines.append('  "*": model')
    for path in paths if kind != "model" else ():
        target = f"{{python: {program}:{_function_name(path)}}}" if kind == "python" else "robot"
        lines.append(f"  {path}: {target}")
    return "\n".join([*lines, "runs: runs", ""])


def _function_name(path: str) -> str:
    return re.sub(r"\W", "_", path.strip("/"))


def _function(path: str, mapping: AbstractionMapping) -> str:
    fields = "".join(f", {field.name}: Any" for field in mapping.activation.fields)
    return (
        f"\n\nasync def {_function_name(path)}(call: Call{fields}) -> dict[str, Any]:\n"
        f'    """Serves {path}: move the robot here."""\n'
        "    for share in (0.25, 0.5, 0.75):\n"
        "        await asyncio.sleep(0.02)\n"
        "        call.progress(share)\n"
        f"    return {pformat(_result(mapping), width=90, sort_dicts=False)}\n"
    )


def _result(mapping: AbstractionMapping) -> dict[str, Any]:
    """Fields that the mapping reads from a result, with an example of their type."""
    result: dict[str, Any] = {}
    for variable in mapping.local_variables:
        if variable.source is LocalSource.SERVICE_RESPONSE and variable.code is not None:
            for field in _FIELD.findall(variable.code.code):
                result[field] = _EXAMPLES.get(variable.type, True)
    return result
