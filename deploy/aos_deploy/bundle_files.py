"""The documents of a deployment's bundles."""

from __future__ import annotations

from pathlib import Path

from aos_deploy.constraints import constrained
from aos_deploy.deploy_file import Deployment
from aos_deploy.mission_values import with_values
from aos_language.load import load_files, read_bundle_files
from aos_language.mission_parameters import declared_values, parameter_leaves
from aos_language.reading.files import skills_of_files
from aos_protocol.diagnostics import has_errors
from aos_protocol.documents import Project
from aos_protocol.errors import DocumentError

__all__ = ["check_mission_of", "files_of_bundle", "project_of"]


def files_of_bundle(bundle: Path, leave_out: tuple[str, ...]) -> dict[str, bytes]:
    """The documents in a bundle's folder or archive by name, without those of skills that are left out."""
    files, remarks = read_bundle_files(bundle)
    if has_errors(remarks):
        found = tuple(remark for remark in remarks if remark.is_error)
        raise DocumentError(f"the bundle {bundle} cannot be read", code=found[0].code, diagnostics=found)
    skills = skills_of_files(files) if leave_out else {}
    return {name: data for name, data in files.items() if skills.get(name) not in leave_out}


def project_of(deployment: Deployment, *, plays_world: bool = False) -> Project:
    """Reads the project that all bundles make together, with the mission's constraints and values.

    DocumentError with all that is wrong with the documents, DeployError AOS801 with what is wrong with the
    constraints and what is set. Documents that only play the world need not have every mission parameter.
    """
    files: dict[str, bytes] = {}
    for bundle in deployment.bundles:
        files |= files_of_bundle(bundle, deployment.file.leave_out)
    loaded = load_files(files, name=deployment.path.name)
    if loaded.project is None:
        raise DocumentError(
            f"the bundles of {deployment.path.name} have errors",
            hint="Mend the places named above",
            diagnostics=loaded.diagnostics,
        )
    project = constrained(loaded.project, deployment.constraints, [deployment.path])
    values = deployment.mission_values
    if plays_world:
        values = declared_values(values, parameter_leaves(project.environment))
    return with_values(project, values, [deployment.path])


def check_mission_of(deployment: Deployment) -> None:
    """Raises DeployError AOS801 with what is wrong with constraints and values; the registry tells of
    documents."""
    if not deployment.constraints and not deployment.mission_values:
        return
    try:
        project_of(deployment)
    except DocumentError:
        return
