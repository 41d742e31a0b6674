"""An adapter to start from, made for a bundle: a deploy file, and a program that serves its paths."""

import re
from importlib.resources import files
from pprint import pformat
from string import Template
from typing import Any

from aos_protocol.codec import PROTOCOL_VERSION
from aos_protocol.documents import AbstractionMapping, LocalSource, Project
from aos_skills.ros.documented import documented

KINDS = ("model", "python", "command", "external", "class", "ros2", "dds", "ros1")

ROS_KINDS = {
    "ros2": ("tcp/127.0.0.1:7447", "where rmw_zenohd listens"),
    "dds": ("lo", "the network interface; lo is this machine alone"),
    "ros1": ("http://127.0.0.1:11311", "ROS_MASTER_URI"),
}
"""The value of each kind of ROS in a deploy file, and what that value is."""

_FIELD = re.compile(r"(\bin\s+)?\b__input(?:, \"|\.(?!\w+\())([A-Za-z_]\w*(?:\.\w+\b(?!\())*)")
_EXAMPLES: dict[str, Any] = {
    "bool": True, "int": 0, "float": 0.0, "double": 0.0, "string": "", "str": "", "float[]": [],
}  # fmt: skip


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
    if kind in ROS_KINDS:
        made["interfaces/README.md"] = _interfaces(project)
    elif kind != "model":
        source = files("aos_deploy") / "templates" / "adapter" / f"{template}.py.template"
        made[program] = Template(source.read_text("utf-8")).substitute(values)
    return made


def _deploy_file(kind: str, project: Project, bundle: str, program: str, paths: list[str]) -> str:
    name = project.name
    if kind == "model":
        budget = "simulations: 10_000, seed: 1}    # for each decision, so that missions repeat"
    else:
        budget = "time_s: 0.2, seed: 1}    # seconds for each decision"
    lines = [
        f"# The robot {name}: what runs when aos-up starts it. Every key: `aos schema deploy`.",
        "aos: 1",
        f"robot: {name}",
        f"bundles: [{bundle}]",
        "mission: {goal_probability: 0.9, step_limit: 30}",
        f"solver: {{{budget}",
    ]
    if kind == "command":
        lines += [
            "# python is the one that AOS runs in. Another one needs eclipse-zenoh and msgspec.",
            "adapters:",
            f"  robot: {{command: [python, {program}]}}",
        ]
    elif kind == "external":
        lines += [
            "bus: {listen: tcp/127.0.0.1:7447}    # where the program finds it, run after run",
            "# The file has the program's password; aos-up makes it once.",
            "adapters:",
            "  robot: {external: '', credential: robot.password}",
        ]
    elif kind == "class":
        lines += [
            "# In the robot's own Python, with the package aos-adapter:",
            f"#   robot: {{command: [python3, -m, aos_runtime.adapters, '{program}:Robot']}}",
            "adapters:",
            f"  robot: {{class: '{program.removesuffix('.py')}:Robot'}}",
        ]
    elif kind in ROS_KINDS:
        value, meaning = ROS_KINDS[kind]
        lines += [
            "# Every option: in the sources of AOS, docs/ros.md.",
            "adapters:",
            "  robot:",
            f"    {kind}: {value}    # {meaning}",
            "    interfaces: [interfaces]    # the robot's own .msg, .srv and .action files",
        ]
    lines.append("bind:")
    everything = {"model": "model"} | dict.fromkeys(ROS_KINDS, "robot")
    if kind in everything:
        lines.append(f'  "*": {everything[kind]}')
    for path in paths if kind not in everything else ():
        target = f"{{python: {program}:{_function_name(path)}}}" if kind == "python" else "robot"
        lines.append(f"  {path}: {target}")
    return "\n".join([*lines, "runs: runs", ""])


def _interfaces(project: Project) -> str:
    """Writes which interface files the documents ask for."""
    known = documented(project)
    lines = ["# The robot's own interfaces", ""]
    lines += ["Copy here, from the robot's workspace, what is not common to all of ROS:", ""]
    for what, types in (("path", known.paths), ("topic", known.topics)):
        for name, type_name in types.items():
            found = (
                f"`{type_name}.{type_name.split('/')[1]}`" if type_name else "the type that the robot says"
            )
            lines.append(f"- the {what} `{name}`: {found}")
    lines += [
        "",
        "Folders are those of packages: `PACKAGE/srv/NAME.srv`. `aos-up` names what is missing.",
        "",
    ]
    return "\n".join(lines)


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
    if mapping.is_derived and (mapping.rules or mapping.response_variable):
        result["response"] = mapping.rules[0].response if mapping.rules else ""
    for variable in mapping.local_variables:
        if variable.source is LocalSource.SERVICE_RESPONSE and variable.code is not None:
            for loop, path in _FIELD.findall(variable.code.code):
                *outer, last = path.split(".")
                fields = result
                for name in outer:
                    if not isinstance(fields.get(name), dict):
                        fields[name] = {}
                    fields = fields[name]
                fields.setdefault(last, [] if loop else _EXAMPLES.get(variable.type, True))
    return result
