"""The documents of a deployment's bundles."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_deploy.deployment.folder import deploy_file_at, deploy_files_in
from aos_deploy.deployment.mission_values import constrained, findings_of, refuse_errors, with_values
from aos_deploy.deployment.reading import Deployment, read_deploy_file
from aos_deploy.printing import from_here
from aos_language.follow_ups import told_once
from aos_language.load import load_files, merge, pushed_project, read_bundle_files
from aos_language.mission_parameters import declared_values, parameter_leaves
from aos_language.reading.files import skills_of_files
from aos_protocol.diagnostics import Diagnostic, has_errors
from aos_protocol.documents import Constraint, MissionValue, Project
from aos_protocol.errors import DeployError, DocumentError
from aos_solver.mission.rules.endings import MissionLimits

MEND = "Mend the places named above"


class BundledFiles(msgspec.Struct, frozen=True):
    """The documents that several bundles make together, by file name, and the bundle of each."""

    files: dict[str, bytes] = {}
    bundles: dict[str, Path] = {}

    def located(self, diagnostic: Diagnostic) -> Diagnostic:
        """The diagnostic with a file name that leads to the file from here."""
        bundle = self.bundles.get(diagnostic.span.file)
        if bundle is None:
            return diagnostic
        span = replace(diagnostic.span, file=str(from_here(bundle) / diagnostic.span.file))
        return replace(diagnostic, span=span)


def files_of_bundles(bundles: tuple[Path, ...], leave_out: tuple[str, ...]) -> BundledFiles:
    """Puts the documents of bundles together, in their order: each replaces the one of its kind and name.

    A bundle need not be complete. DocumentError where one cannot be read, or be put over those before it.
    """
    together = BundledFiles()
    for bundle in bundles:
        files = files_of_bundle(bundle, leave_out)
        merged = merge(together.files, files)
        places = together.bundles | dict.fromkeys(files, bundle)
        together = BundledFiles(merged.files, {name: places[name] for name in merged.files})
        if has_errors(merged.diagnostics):
            found = tuple(together.located(diagnostic) for diagnostic in merged.diagnostics)
            raise DocumentError(f"the bundle {bundle} is refused", code="AOS120", diagnostics=found)
    return together


def files_of_deployment(deployment: Deployment) -> BundledFiles:
    """Puts the documents of a deployment's bundles together, as `files_of_bundles` does; DeployError AOS801
    where they are of another project than the deploy file says."""
    together = files_of_bundles(deployment.bundles, deployment.file.leave_out)
    name = pushed_project(together.files)
    if name and name != deployment.project:
        place = deployment.project_place
        findings = findings_of([place.file])
        message = f"the documents are of the project {name}, not {deployment.project}"
        write = f"Write `project: {name}`"
        hint = (
            f"{write} here" if deployment.file.project else f"{write} below it: else the robot's name counts"
        )
        findings.error("AOS106", message, place, hint)
        refuse_errors(findings, f"the deploy file {from_here(deployment.path)} has errors")
    return together


def files_of_bundle(bundle: Path, leave_out: tuple[str, ...]) -> dict[str, bytes]:
    """The documents in a bundle's folder or archive by name, without those of skills that are left out."""
    files, remarks = read_bundle_files(bundle)
    if has_errors(remarks):
        found = tuple(remark for remark in remarks if remark.is_error)
        raise DocumentError(f"the bundle {bundle} cannot be read", code=found[0].code, diagnostics=found)
    skills = skills_of_files(files) if leave_out else {}
    return {name: data for name, data in files.items() if skills.get(name) not in leave_out}


class Planned(msgspec.Struct, frozen=True):
    """The documents that a command plans with, and what a deploy file sets for the mission.

    `sources` are the files in which constraints and values stand. `horizon` is None where the environment
    document's counts, and `limits` where none end a mission.
    """

    path: Path
    files: dict[str, bytes]
    remarks: tuple[Diagnostic, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    values: tuple[MissionValue, ...] = ()
    sources: tuple[Path, ...] = ()
    horizon: int | None = None
    limits: MissionLimits | None = None
    plans_to_step_limit: bool = False


def planned_of(path: Path) -> Planned:
    """Reads a bundle, or the bundles of a deploy file; errors are those of `read_deploy_file`."""
    deployment = deployment_at(path)
    if deployment is None:
        files, remarks = read_bundle_files(path)
        return Planned(path, files, tuple(remarks))
    together = files_of_deployment(deployment)
    return Planned(
        path,
        together.files,
        constraints=deployment.constraints,
        values=deployment.mission_values,
        sources=(deployment.path,),
        horizon=deployment.file.solver.horizon,
        limits=msgspec.convert(deployment.file.mission, MissionLimits, from_attributes=True),
        plans_to_step_limit=deployment.file.solver.plans_to_step_limit,
    )


def deployment_at(path: Path) -> Deployment | None:
    """Reads a deploy file, as `read_deploy_file` does; None for a bundle.

    A folder with no document and a deploy file stands for that file, as it does for `aos-up`.
    """
    if path.is_dir() and not read_bundle_files(path)[0] and next(deploy_files_in(path), None):
        path = deploy_file_at(path)
    is_deploy_file = path.suffix in (".yaml", ".yml") and path.is_file()
    return read_deploy_file(path) if is_deploy_file else None


def project_at(place: Path | Planned, *, hint: str = MEND) -> tuple[Planned, Project, tuple[Diagnostic, ...]]:
    """Reads the project of what `planned_of` reads or has read, with warnings and remarks; DocumentError with
    all that is wrong with its documents."""
    planned = planned_of(place) if isinstance(place, Path) else place
    path = planned.path
    loaded = load_files(planned.files, name=path.name or str(path), remarks=planned.remarks)
    if loaded.project is None:
        raise refusal(path, loaded.diagnostics, hint)
    return planned, loaded.project, loaded.diagnostics


def refusal(bundle: Path, diagnostics: tuple[Diagnostic, ...], hint: str = MEND) -> DocumentError:
    """Returns the error that is raised for a bundle with errors."""
    return DocumentError(f"{bundle} has errors", code="AOS120", hint=hint, diagnostics=told_once(diagnostics))


def project_of(deployment: Deployment, *, plays_world: bool = False) -> Project:
    """Reads the project that all bundles make together, with the mission's constraints and values.

    DocumentError with all that is wrong with the documents, DeployError AOS801 with what is wrong with the
    deploy file's project, its constraints and what it sets. Documents that only play the world need not have
    every mission parameter.
    """
    together = files_of_deployment(deployment)
    loaded = load_files(together.files, name=deployment.path.name)
    if loaded.project is None:
        named = ", ".join(str(from_here(bundle)) for bundle in deployment.bundles)
        raise DocumentError(
            f"the bundles {named} are refused" if "," in named else f"the bundle {named} is refused",
            code="AOS120",
            hint=MEND,
            diagnostics=tuple(map(together.located, told_once(loaded.diagnostics))),
        )
    values = deployment.mission_values
    if plays_world:
        values = declared_values(values, parameter_leaves(loaded.project.environment))
    return with_mission(loaded.project, deployment.constraints, values, [deployment.path])


def with_mission(
    project: Project,
    constraints: Sequence[Constraint],
    values: Sequence[MissionValue],
    sources: Sequence[Path],
) -> Project:
    """The project with constraints and values, whose `sources` are files; DeployError AOS801 with all that
    is wrong with them."""
    refused: list[DeployError] = []
    try:
        project = constrained(project, constraints, sources)
    except DeployError as error:
        refused.append(error)
    try:
        project = with_values(project, values, sources)
    except DeployError as error:
        refused.append(error)
    if len(refused) > 1:
        found = tuple(diagnostic for error in refused for diagnostic in error.diagnostics)
        what = "the mission's constraints and what is set for it have errors"
        raise DeployError(what, diagnostics=found)
    for only in refused:
        raise only
    return project
