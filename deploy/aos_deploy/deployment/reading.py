"""The reading of a deploy file: its paths made absolute, and what its parts alone cannot tell checked.

One YAML file, read and checked as a whole: everything wrong with it is reported in one run, each finding with
its line and column. Paths in it are relative to its own folder.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.deployment.adapters import AdapterPlan, played_by_model, read_adapters
from aos_deploy.deployment.folder import absolute, deploy_file_at, is_file, is_folder, is_there, named
from aos_deploy.deployment.hosts import is_collector_address
from aos_deploy.deployment.mission_values import snippet_of, values_of_node
from aos_deploy.deployment.own_programs import check_programs
from aos_deploy.deployment.parts import DeployFile
from aos_deploy.deployment.typed import known_names, read_structure
from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlNode, YamlScalar, read_yaml
from aos_language.archive import is_archive_name
from aos_language.findings import Findings
from aos_language.load import read_bundle_files
from aos_language.reading.files import skills_of_files
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Constraint, MissionValue
from aos_protocol.errors import DeployError
from aos_protocol.keys import NAME
from aos_protocol.spelling import did_you_mean_path

_ENDPOINT = re.compile(r"tcp/(127\.\d+\.\d+\.\d+|localhost|\[::1\]):(\d{1,5})")
_LAST_PORT = 65535


class Deployment(msgspec.Struct, frozen=True, kw_only=True):
    """A deploy file that holds together, its paths absolute.

    `project_place` is where it names the project: its robot, if that has the project's name.
    """

    path: Path
    file: DeployFile
    project: str
    project_place: Span
    bundles: tuple[Path, ...]
    world: Path | None
    adapters: tuple[AdapterPlan, ...]
    policy: Path | None
    constraints: tuple[Constraint, ...]
    mission_values: tuple[MissionValue, ...] = ()
    watch: Path | None
    runs: Path


def read_deploy_file(path: Path) -> Deployment:
    """The deployment a file describes; DeployError AOS801 with all diagnostics if it has errors.

    In place of the file a folder with one deploy file may be given.
    """
    path = deploy_file_at(path)
    named = str(path)
    node, findings = read_yaml(path, named)
    deployment = None
    if node is not None:
        file = read_structure(node, DeployFile, findings)
        if file is not None:
            deployment = _resolve(absolute(path), file, node, findings)
    if deployment is None or findings.has_errors:
        raise DeployError(f"the deploy file {named} has errors", diagnostics=findings.sorted())
    return deployment


def without_a_robot(deployment: Deployment, faults: Mapping[str, float] | None = None) -> Deployment:
    """The deployment with every skill played by its document. What runs beside a robot is left out, too."""
    file = replace(deployment.file, programs={})
    return replace(deployment, file=file, adapters=played_by_model(faults))


def with_whole_paths(deployment: Deployment) -> DeployFile:
    """The file with what it leaves to defaults, and with paths that hold in every folder."""
    file, policy = deployment.file, deployment.policy
    return replace(
        file,
        project=deployment.project,
        bundles=tuple(map(str, deployment.bundles)),
        world=_text(deployment.world),
        watch=_text(deployment.watch),
        runs=str(deployment.runs),
        solver=replace(file.solver, policy=_text(policy)),
    )


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)


def check_endpoint(endpoint: str) -> None:
    """Raises DeployError AOS801 unless it is one of this machine alone: everything else needs protection
    first."""
    match = _ENDPOINT.fullmatch(endpoint)
    if match is None or int(match[2]) > _LAST_PORT:
        hint = "Write it as tcp/127.0.0.1:7447, with port 0 for any free one, or leave it out"
        raise DeployError(f"{endpoint!r} is not an endpoint of this machine", hint=hint)


def _resolve(path: Path, file: DeployFile, node: YamlMap, findings: Findings) -> Deployment:
    """The paths made absolute, and what the schema alone cannot see checked."""
    folder = path.parent
    if not NAME.fullmatch(file.robot):
        hint = "Use letters, digits, - and _"
        findings.error("AOS106", f"{file.robot!r} is not a robot name", _place(node, "robot"), hint)
    try:
        if file.bus.listen:
            check_endpoint(file.bus.listen)
    except DeployError as error:
        findings.error("AOS106", error.message, _place(node, "bus", "listen"), error.hint)
    if file.spans.otlp and not is_collector_address(file.spans.otlp):
        hint = "Write it as http://127.0.0.1:4318"
        where = _place(node, "spans", "otlp")
        findings.error("AOS106", f"{file.spans.otlp!r} is no collector's address", where, hint)
    if file.solver.simulations is not None and file.solver.time_s is not None:
        where = _place(node, "solver", "time_s")
        findings.error("AOS106", "solver has both simulations and time_s", where, "Keep one of them")
    bundles = _bundles(folder, file, node, findings)
    world = folder / file.world if file.world is not None else None
    if world is not None and not is_file(world):
        findings.error(
            "AOS101",
            f"there is no world file {named(world)}",
            _place(node, "world"),
            did_you_mean_path(world),
        )
    policy = folder / file.solver.policy if file.solver.policy is not None else None
    if policy is not None and not is_file(policy):
        hint, where = "Write it with aos solve", _place(node, "solver", "policy")
        findings.error("AOS101", f"there is no policy file {named(policy)}", where, hint)
    watch = folder / file.watch if file.watch is not None else None
    if watch is not None and is_there(watch) and not is_folder(watch):
        findings.error("AOS106", f"watch: {named(watch)} is no folder", _place(node, "watch"))
    adapters = read_adapters(node, findings, str(world) if world else "")
    check_programs(file.programs, node, findings, {*file.adapters, *(plan.name for plan in adapters)})
    return Deployment(
        path=path,
        file=file,
        project=file.project or file.robot,
        project_place=_place(node, "project" if file.project else "robot"),
        bundles=bundles,
        world=world,
        adapters=adapters,
        policy=policy,
        constraints=_constraints(path, file, node),
        mission_values=_mission_values(path, node, findings),
        watch=watch,
        runs=absolute(folder / file.runs),
    )


def _constraints(path: Path, file: DeployFile, node: YamlMap) -> tuple[Constraint, ...]:
    """The mission's constraints with their places; what they name is checked with the bundles' documents."""
    mission = node.entries.get("mission")
    listed = mission.entries.get("constraints") if isinstance(mission, YamlMap) else None
    places = [
        item.entries["never"]
        for item in (listed.items if isinstance(listed, YamlList) else ())
        if isinstance(item, YamlMap) and isinstance(item.entries.get("never"), YamlScalar)
    ]
    return tuple(
        Constraint(
            snippet_of(
                part.never.rstrip(), replace(place.text_span, file=str(path)), is_block=place.is_block
            ),
            part.probability,
            part.cost,
        )
        for part, place in zip(file.mission.constraints, places, strict=False)
        if isinstance(place, YamlScalar)
    )


def _mission_values(path: Path, node: YamlMap, findings: Findings) -> tuple[MissionValue, ...]:
    """The values that are set; whether the documents have such parameters is checked with these."""
    mission = node.entries.get("mission")
    given = mission.entries.get("set") if isinstance(mission, YamlMap) else None
    return values_of_node(given, findings, str(path))


def _bundles(folder: Path, file: DeployFile, node: YamlMap, findings: Findings) -> tuple[Path, ...]:
    if not file.bundles:
        findings.error("AOS105", "bundles names none", _place(node, "bundles"), "Name a bundle's folder")
    for name, where in _texts(node, "bundles"):
        if not _is_bundle(folder / name):
            bundle = folder / name
            findings.error(
                "AOS101", f"there is no bundle folder {named(bundle)}", where, did_you_mean_path(bundle)
            )
    bundles = tuple(absolute(folder / name) for name in file.bundles)
    if all(map(_is_bundle, bundles)):
        _check_skills(file, bundles, node, findings)
    return bundles


def _check_skills(file: DeployFile, bundles: Sequence[Path], node: YamlMap, findings: Findings) -> None:
    """The skills that the file names are those of bundles; a folder that is watched may bring others."""
    said = list(_texts(node, "leave_out"))
    settings = node.entries.get("skills")
    if isinstance(settings, YamlMap) and file.watch is None:
        said += settings.keys.items()
    if not said:
        return
    skills = {skill for bundle in bundles for skill in skills_of_files(read_bundle_files(bundle)[0]).values()}
    for skill, where in said:
        if skill not in skills:
            findings.unknown(skill, skills, f"no bundle has a skill {skill}", where, known_names(skills))


def _is_bundle(path: Path) -> bool:
    return is_folder(path) or (is_archive_name(path.name) and is_file(path))


def _texts(node: YamlMap, key: str) -> Iterator[tuple[str, Span]]:
    listed = node.entries.get(key)
    for item in listed.items if isinstance(listed, YamlList) else ():
        if isinstance(item, YamlScalar) and isinstance(item.value, str):
            yield item.value, item.span


def _place(node: YamlMap, *path: str) -> Span:
    """Returns the place of a value; the file's beginning, if the value is not in the file."""
    found: YamlNode = node
    for key in path:
        if not isinstance(found, YamlMap) or key not in found.entries:
            return node.span
        found = found.entries[key]
    return found.span
