"""The deploy file: which robot, documents, world and budgets make up a system.

One YAML file, read and checked as a whole: everything wrong with it is reported in one run, each finding with
its line and column. Paths in it are relative to its own folder.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from aos_protocol.diagnostics import Span, has_errors
from aos_protocol.errors import DeployError
from aos_deploy.typed import nearest, read_structure
from aos_deploy.yaml_source import Findings, YamlList, YamlMap, YamlScalar, read_yaml

__all__ = ["BusPart", "Deployment", "DeployFile", "MissionPart", "SolverPart", "read_deploy_file"]

Probability = Annotated[float, msgspec.Meta(gt=0, le=1)]
Seconds = Annotated[float, msgspec.Meta(gt=0)]
Count = Annotated[int, msgspec.Meta(ge=1)]
Seed = Annotated[int, msgspec.Meta(ge=0, lt=2**63)]

_NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")
_ENDPOINT = re.compile(r"tcp/(127\.\d+\.\d+\.\d+|localhost|\[::1\]):\d{1,5}")


class BusPart(msgspec.Struct, frozen=True, kw_only=True):
    """Where the router listens; port 0 takes any free one."""

    listen: str = "tcp/127.0.0.1:7447"


class MissionPart(msgspec.Struct, frozen=True, kw_only=True):
    """When a mission ends. `stop_below_value` is an expected return; without it nothing is too poor to try."""

    goal_probability: Probability = 0.9
    step_limit: Count = 30
    stop_below_value: float | None = None
    activation_timeout_s: Seconds = 120.0


class SolverPart(msgspec.Struct, frozen=True, kw_only=True):
    """The budget of one decision, in simulations or in time, and what makes it reproducible.

    Without a horizon the environment document's holds.
    """

    simulations: Count | None = None
    time_s: Seconds | None = None
    horizon: Count | None = None
    seed: Seed = 1
    impossible_observation: Literal["hold", "widen", "reset"] = "widen"


class DeployFile(msgspec.Struct, frozen=True, kw_only=True):
    """The file as it is written; what is not required has the defaults given here.

    `project` is the project that the bundles' documents name, by default the robot's name. `leave_out` names
    skills of the bundles that are not there at the start. `watch` is the folder whose sub-folders the registry
    takes as bundles, by default `drop` in the run directory. `bind` says which adapter serves which activation
    path of the abstraction mappings. `runs` is where run directories go.
    """

    aos: Literal[1]
    robot: str
    bundles: tuple[str, ...]
    project: str = ""
    leave_out: tuple[str, ...] = ()
    watch: str | None = None
    bus: BusPart = BusPart()
    mission: MissionPart = MissionPart()
    solver: SolverPart = SolverPart()
    world: str | None = None
    bind: dict[str, str] = {}
    runs: str = "runs"


class Deployment(msgspec.Struct, frozen=True, kw_only=True):
    """A deploy file that holds together, its paths absolute."""

    path: Path
    file: DeployFile
    project: str
    bundles: tuple[Path, ...]
    world: Path | None
    watch: Path | None
    runs: Path


def read_deploy_file(path: Path) -> Deployment:
    """The deployment a file describes; DeployError AOS801 with all diagnostics if it has errors."""
    named = str(path)
    node, findings = read_yaml(path, named)
    deployment = None
    if node is not None:
        file = read_structure(node, DeployFile, findings)
        if file is not None:
            deployment = _resolve(path.resolve(), file, node, findings)
    if deployment is None or has_errors(findings.diagnostics):
        raise DeployError(
            f"the deploy file {named} has errors",
            code="AOS801",
            diagnostics=tuple(sorted(findings.diagnostics, key=lambda finding: finding.span)),
        )
    return deployment


def _resolve(path: Path, file: DeployFile, node: YamlMap, findings: Findings) -> Deployment:
    """The paths made absolute, and what the schema alone cannot see checked."""
    folder = path.parent
    for key, name in (("robot", file.robot), ("project", file.project or file.robot)):
        if not _NAME.fullmatch(name):
            hint = "Use letters, digits, - and _"
            findings.error("AOS106", f"{name!r} is not a {key} name", _place(node, key), hint)
    if not _ENDPOINT.fullmatch(file.bus.listen):
        findings.error(
            "AOS106",
            f"{file.bus.listen!r} is not an endpoint of this machine",
            _place(node, "bus", "listen"),
            "Write it as tcp/127.0.0.1:7447, with port 0 for any free one",
        )
    if file.solver.simulations is not None and file.solver.time_s is not None:
        where = _place(node, "solver", "time_s")
        findings.error("AOS106", "solver has both simulations and time_s", where, "Keep one of them")
    bundles = _bundles(folder, file, node, findings)
    world = folder / file.world if file.world is not None else None
    if world is not None and not world.is_file():
        findings.error("AOS101", f"there is no world file {world}", _place(node, "world"))
    return Deployment(
        path=path,
        file=file,
        project=file.project or file.robot,
        bundles=bundles,
        world=world,
        watch=folder / file.watch if file.watch is not None else None,
        runs=(folder / file.runs).resolve(),
    )


def _bundles(folder: Path, file: DeployFile, node: YamlMap, findings: Findings) -> tuple[Path, ...]:
    bundles = tuple((folder / name).resolve() for name in file.bundles)
    if not bundles:
        findings.error("AOS105", "bundles is empty", _place(node, "bundles"), "Name a bundle's folder")
    for index, bundle in enumerate(bundles):
        if not bundle.is_dir():
            findings.error("AOS101", f"there is no bundle folder {bundle}", _place(node, "bundles", index))
    skills = {document.stem for bundle in bundles if bundle.is_dir() for document in bundle.iterdir()}
    for index, skill in enumerate(file.leave_out):
        if skill not in skills:
            where = _place(node, "leave_out", index)
            findings.error("AOS110", f"no bundle has a skill {skill}", where, nearest(skill, skills))
    return bundles


def _place(node: YamlMap, *path: str | int) -> Span:
    """Where a value stands; of the nearest there is, if it is not in the file."""
    found: YamlMap | YamlList | YamlScalar = node
    for step in path:
        if isinstance(found, YamlMap) and step in found.entries:
            found = found.entries[str(step)]
        elif isinstance(found, YamlList) and isinstance(step, int):
            found = found.items[step]
    return found.span
