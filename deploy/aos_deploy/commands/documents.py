"""`aos lint` and `aos inspect`: documents checked and looked at, without a running system."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from aos_deploy.bundles.bindings import binding_findings
from aos_deploy.bundles.files import deployment_at, planned_of, project_at, refusal, with_mission
from aos_deploy.bundles.sarif import sarif_log
from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, TrustDocuments, command
from aos_deploy.printing import count, print_diagnostics, print_json
from aos_language.follow_ups import told_once
from aos_language.load import load_files, with_excerpts
from aos_language.outline import outline
from aos_language.reading.picture_file import PICTURE
from aos_protocol import __version__
from aos_protocol.diagnostics import Diagnostic, Severity, Span, has_errors
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DeployError


class Format(StrEnum):
    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"


class Stage(StrEnum):
    DOCUMENTS = "documents"
    MODEL = "model"
    CPP = "cpp"
    PYTHON = "python"


_DOCUMENTS = "A directory with .ef, .sd, .am, .lf or .json documents, or an archive of one"
Folder = Annotated[Path, typer.Argument(metavar="BUNDLE", help=_DOCUMENTS)]
FolderOrDeployFile = Annotated[
    Path, typer.Argument(metavar="BUNDLE", help=f"{_DOCUMENTS}; or a deploy file, for its bundles together")
]


@command("Example: aos lint deploy/bundles/armadillo-finer")
def lint(
    path: FolderOrDeployFile,
    form: Annotated[Format, typer.Option("--format", help="How to print the findings")] = Format.TEXT,
    as_json: AsJson = False,
    compiles: Annotated[
        bool, typer.Option("--compile/--no-compile", help="Whether the compiler looks at the C++ as well")
    ] = True,
    also: Annotated[
        list[Path] | None,
        typer.Option(metavar="BUNDLE", exists=True, help="A bundle that this one adds to; repeatable"),
    ] = None,
    trust_documents: TrustDocuments = False,
) -> None:
    """Check a bundle and print everything that is wrong.

    Of a deploy file all bundles are checked together.

    The model is generated and compiled too, without skills whose declarations have mistakes and unless those
    of the environment do, and mistakes in its C++ are told at their place in the documents; the built model
    is kept for later. Exit code 0: clean, or warnings only. 1: errors.
    """
    form = Format.JSON if as_json else form
    try:
        files, remarks = _files_of([*(also or ()), path])
    except AosError as error:
        if form is Format.TEXT or not error.diagnostics:
            raise  # Else the findings of a deploy file are data, as those of documents are.
        _print_data(form, path, error.diagnostics, "")
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG) from None
    loaded = load_files(files, name=path.name or str(path), remarks=remarks)
    found = loaded.diagnostics
    if compiles and loaded.project is not None:
        # A picture.py that cannot be read is not drawn as well: it would be told twice.
        tried = {n: text for n, text in files.items() if not any(f.span.file == n == PICTURE for f in found)}
        more = _model_findings(tried, path, loaded.project)
        if any("no state variable is a" in finding.message for finding in found):
            more = tuple(finding for finding in more if finding.code != "AOS211")  # They look for an object.
        found = (*found, *more)
    elif compiles and loaded.draft is not None:
        told = {(finding.span.file, finding.span.line) for finding in found if finding.is_error}
        more = _compiler_errors(files, loaded.draft)
        found = (*found, *(error for error in more if (error.span.file, error.span.line) not in told))
    found = (*told_once(found), *_of_deploy_file(path, loaded.project, loaded.draft))
    if form is not Format.TEXT:
        _print_data(form, path, found, loaded.digest)
    else:
        print_diagnostics(found)
        counts = Counter(diagnostic.severity for diagnostic in found)
        errors, warnings = counts[Severity.ERROR], counts[Severity.WARNING]
        typer.echo(f"{path}: {count(errors, 'error')}, {count(warnings, 'warning')}")
        if not also and any(diagnostic.code == "AOS115" for diagnostic in found):
            typer.echo(f"If it adds to another bundle, check them together: aos lint {path} --also BUNDLE")
    if has_errors(found):
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def _files_of(bundles: Iterable[Path]) -> tuple[dict[str, bytes], list[Diagnostic]]:
    """The documents of all, where a later one's stand in place of those of the same name."""
    files: dict[str, bytes] = {}
    remarks: list[Diagnostic] = []
    for bundle in bundles:
        planned = planned_of(bundle)
        files |= planned.files
        remarks += planned.remarks
    return files, remarks


def _print_data(form: Format, path: Path, found: Sequence[Diagnostic], digest: str) -> None:
    """Prints findings as data; the digest is that of the documents, nothing where none were read."""
    if form is Format.SARIF:
        print_json(sarif_log(found, folder=str(path), version=__version__))
        return
    counts = Counter(diagnostic.severity for diagnostic in found)
    errors, warnings = counts[Severity.ERROR], counts[Severity.WARNING]
    told = {"bundle": str(path), "errors": errors, "warnings": warnings, "digest": digest}
    print_json(told | {"diagnostics": found})


def _of_deploy_file(path: Path, project: Project | None, draft: Project | None) -> tuple[Diagnostic, ...]:
    """Returns what is wrong with a deploy file in the light of its documents; nothing for a bundle."""
    deployment = deployment_at(path)
    read = project or draft
    if deployment is None or read is None:
        return ()
    found = binding_findings(deployment, read)
    if project is None:
        return found
    try:
        with_mission(project, deployment.constraints, deployment.mission_values, [deployment.path])
    except DeployError as error:
        return (*found, *error.diagnostics)
    return found


def _model_findings(files: Mapping[str, bytes], path: Path, project: Project) -> tuple[Diagnostic, ...]:
    """Generates and compiles the model and returns what that finds."""
    import asyncio  # These would make the other commands start slower.

    from aos_deploy.bundles.pictures import picture_findings
    from aos_deploy.bundles.reachability import reachability_findings
    from aos_deploy.places import cache_dir
    from aos_solver.building.project_build import build_project, lowered

    async def findings() -> tuple[Diagnostic, ...]:
        built = await build_project(project, cache_dir(), tell)
        return (*await reachability_findings(project, built), *await picture_findings(files, built))

    def tell(progress: str) -> None:
        typer.echo(f"aos: {progress}", err=True)

    try:
        reached = asyncio.run(findings())
    except AosError as error:
        if isinstance(error, DeployError):
            raise  # The machine lacks something; the documents may be right.
        if not error.diagnostics:
            return (Diagnostic(Severity.ERROR, error.code, error.message, Span(path.name), error.hint),)
        return with_excerpts(error.diagnostics, files)
    _, warnings = lowered(project)
    return with_excerpts((*warnings, *reached), files)


def _compiler_errors(files: Mapping[str, bytes], draft: Project) -> tuple[Diagnostic, ...]:
    """Errors of the compiler in documents that have other mistakes as well."""
    import asyncio  # As above.

    from aos_deploy.places import cache_dir
    from aos_solver.building.project_build import build_project
    from aos_solver.emission.lowering.lower import skills_looked_for

    try:
        asyncio.run(build_project(draft, cache_dir()))
    except AosError as error:
        # A skill that is left out for a mistake of its own has no parameters that code may look at.
        absent = [f"{name}->" for name in skills_looked_for(draft)]
        told = [found for found in error.diagnostics if found.code in ("AOS124", "AOS201")]
        found = with_excerpts(told, files)
        return tuple(one for one in found if not any(parameter in one.excerpt for parameter in absent))
    return ()


@command("Example: aos inspect deploy/bundles/armadillo-finer --stage documents")
def inspect(
    bundle: FolderOrDeployFile,
    stage: Annotated[Stage, typer.Option(help="Which stage to print")] = Stage.DOCUMENTS,
    skill: Annotated[str, typer.Option(help="Only this skill's module, for the stage python")] = "",
    as_json: AsJson = False,
) -> None:
    """Print what becomes of a bundle.

    The typed documents, the lowered model, the C++ or the Python. A deploy file's constraints and values are
    in the model. With --json it is an object with the stage as its key.
    """
    planned, project, _ = project_at(bundle)
    project = with_mission(project, planned.constraints, planned.values, planned.sources)
    found: object = project
    if stage is Stage.PYTHON:
        found = _python_modules(project, skill)
    elif stage is not Stage.DOCUMENTS:
        found = _solver_stage(project, stage, bundle)
    if as_json:
        print_json({stage.value: found})
    elif isinstance(found, str):
        typer.echo(found, nl=False)
    elif stage is Stage.MODEL:
        print_json(found)
    else:
        typer.echo(outline(project), nl=False)


def _python_modules(project: Project, only: str) -> str:
    from aos_middleware.emission.emit import (  # Keeps the other commands quick to start.
        emit_mapping,
        emit_monitor,
    )

    names = [*(skill.name for skill in project.skills), *(mapping.monitor for mapping in project.monitors)]
    if only and only not in names:
        raise typer.BadParameter(f"the skills are {', '.join(names)}", param_hint="--skill")
    low_level, shared = project.low_level, project.environment.shared_mapping_code
    skills = [skill for skill in project.skills if only in ("", skill.name)]
    monitors = [mapping for mapping in project.monitors if only in ("", mapping.monitor)]
    emitted = [emit_mapping(skill, low_level, shared=shared) for skill in skills]
    emitted += [emit_monitor(mapping, low_level, shared) for mapping in monitors]
    return "\n\n".join(mapping.python for mapping in emitted)


def _solver_stage(project: Project, stage: Stage, bundle: Path) -> object:
    """The lowered model, or its C++ as text."""
    from aos_solver.emission.emit import emit  # As above.
    from aos_solver.emission.lowering.lower import lower

    program, diagnostics = lower(project)
    if program is None:
        raise refusal(bundle, diagnostics)
    return emit(program).cpp if stage is Stage.CPP else program
