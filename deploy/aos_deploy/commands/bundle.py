"""`aos bundle`, `aos lint` and `aos inspect`: documents checked, looked at, and sent to a registry."""

from __future__ import annotations

from collections import Counter
from collections.abc import Awaitable, Callable, Iterable
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import msgspec
import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.run_directory import RunDirectory
from aos_protocol.diagnostics import Diagnostic, Severity, has_errors, render
from aos_protocol.documents import Project
from aos_protocol.errors import DeployError, DocumentError
from aos_protocol.messages import (
    BundleReport,
    Catalogue,
    CatalogueQuery,
    ProjectQuery,
    ProjectRevision,
    PushBundle,
)
from aos_registry.load import load_bundle, read_bundle_files
from aos_registry.outline import outline

if TYPE_CHECKING:
    from aos_runtime.client import AosClient

__all__ = ["register"]

ANSWER_TIMEOUT_S = 5.0
PUSH_TIMEOUT_S = 200.0
"""The registry lets the solver compile a new model before it accepts it."""

T = TypeVar("T")

bundle_app = typer.Typer(
    no_args_is_help=True, help="Send documents to a running system, and see what it holds."
)


class Format(StrEnum):
    TEXT = "text"
    JSON = "json"


class Stage(StrEnum):
    DOCUMENTS = "documents"
    MODEL = "model"
    CPP = "cpp"
    PYTHON = "python"


Connect = Annotated[
    str,
    typer.Option("--connect", metavar="ENDPOINT", help="Where the system's bus listens; else the last run"),
]
Robot = Annotated[str, typer.Option("--robot", help="The robot's name; else that of the last run")]
Runs = Annotated[Path, typer.Option("--runs", help="Where the run directories are")]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON")]
Folder = Annotated[
    Path, typer.Argument(metavar="DIR", help="A directory with .ef, .sd, .am or .json documents")
]


def register(app: typer.Typer) -> None:
    """Adds the commands to `aos`."""
    app.add_typer(bundle_app, name="bundle")
    app.command(epilog="Example: aos lint deploy/bundles/armadillo-finer")(lint)
    app.command(epilog="Example: aos inspect deploy/bundles/armadillo-finer --stage documents")(inspect)


# --- without a running system --------------------------------------------------------------------------


def lint(
    path: Folder,
    form: Annotated[Format, typer.Option("--format", help="How to print the findings")] = Format.TEXT,
) -> None:
    """Check a bundle of documents and print everything that is wrong with it.

    Exit code 0: clean, or warnings only. 1: errors.
    """
    loaded = load_bundle(path)
    counts = Counter(diagnostic.severity for diagnostic in loaded.diagnostics)
    if form is Format.JSON:
        _print_json(
            {
                "bundle": str(path),
                "errors": counts[Severity.ERROR],
                "warnings": counts[Severity.WARNING],
                "digest": loaded.digest,
                "diagnostics": loaded.diagnostics,
            }
        )
    else:
        _print_diagnostics(loaded.diagnostics)
        errors, warnings = counts[Severity.ERROR], counts[Severity.WARNING]
        typer.echo(f"{path}: {_count(errors, 'error')}, {_count(warnings, 'warning')}")
    if loaded.has_errors:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def inspect(
    bundle: Folder,
    stage: Annotated[Stage, typer.Option(help="Which stage to print")] = Stage.DOCUMENTS,
    skill: Annotated[str, typer.Option(help="Only this skill's module, for the stage python")] = "",
) -> None:
    """Print what becomes of a bundle: the typed documents, the lowered model, the C++ or the Python."""
    loaded = load_bundle(bundle)
    if loaded.project is None:
        raise _refusal(bundle, loaded.diagnostics)
    if stage is Stage.DOCUMENTS:
        typer.echo(outline(loaded.project), nl=False)
    elif stage is Stage.PYTHON:
        typer.echo(_python_modules(loaded.project, skill), nl=False)
    else:
        typer.echo(_solver_stage(loaded.project, stage, bundle), nl=False)


def _python_modules(project: Project, only: str) -> str:
    from aos_middleware.emit import emit_mapping  # Keeps the other commands quick to start.

    names = [skill.name for skill in project.skills]
    if only and only not in names:
        raise typer.BadParameter(f"the skills are {', '.join(names)}", param_hint="--skill")
    chosen = [skill for skill in project.skills if only in ("", skill.name)]
    return "\n\n".join(emit_mapping(skill, project.low_level).python for skill in chosen)


def _solver_stage(project: Project, stage: Stage, bundle: Path) -> str:
    from aos_solver.emit import emit  # As above.
    from aos_solver.lower import lower

    program, diagnostics = lower(project)
    if program is None:
        raise _refusal(bundle, diagnostics)
    if stage is Stage.CPP:
        return emit(program).cpp
    return msgspec.json.format(msgspec.json.encode(program), indent=2).decode() + "\n"


def _refusal(bundle: Path, diagnostics: tuple[Diagnostic, ...]) -> DocumentError:
    hint = "Mend the places named above"
    return DocumentError(f"{bundle} has errors", code="AOS120", hint=hint, diagnostics=diagnostics)


# --- a running system ----------------------------------------------------------------------------------


@bundle_app.command(epilog="Example: aos bundle push deploy/bundles/armadillo-finer")
def push(
    path: Folder,
    connect: Connect = "",
    robot: Robot = "",
    runs: Runs = Path("runs"),
    as_json: AsJson = False,
) -> None:
    """Send a bundle to the registry: a new project, new skills, or better documents of old ones.

    Exit code 0: accepted, or nothing new. 1: refused; nothing has changed then.
    """
    files, remarks = read_bundle_files(path)
    if has_errors(remarks):
        raise _refusal(path, tuple(remarks))
    if not files:
        hint = "Documents end in .ef, .sd, .am or .json"
        raise DocumentError(f"there are no documents in {path}", code="AOS120", hint=hint)

    async def send(client: AosClient) -> BundleReport:
        bundle = PushBundle(files, str(path))
        return await client.bus.ask(client.keys.push_bundle, bundle, BundleReport, timeout_s=PUSH_TIMEOUT_S)

    report = _with_client(connect, robot, runs, send)
    if as_json:
        _print_json(report)
    else:
        _print_diagnostics((*remarks, *report.diagnostics))
        typer.echo(_sentence(report, path))
    if not report.is_accepted:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


@bundle_app.command("list", epilog="Example: aos bundle list")
def list_projects(
    connect: Connect = "", robot: Robot = "", runs: Runs = Path("runs"), as_json: AsJson = False
) -> None:
    """List the projects that the registry holds, with their skills."""

    async def ask(client: AosClient) -> Catalogue:
        key = client.keys.catalogue
        return await client.bus.ask(key, CatalogueQuery(), Catalogue, timeout_s=ANSWER_TIMEOUT_S)

    catalogue = _with_client(connect, robot, runs, ask)
    if as_json:
        _print_json(catalogue)
        return
    for entry in catalogue.entries:
        stored = datetime.fromtimestamp(entry.stored_ns / 1e9, UTC).isoformat(timespec="seconds")
        typer.echo(f"{entry.project}  revision {entry.revision}  {entry.digest[:12]}  {stored}")
        typer.echo(f"  {', '.join(entry.skills)}")
    if not catalogue.entries:
        typer.echo("The registry holds no projects.")


@bundle_app.command(epilog="Example: aos bundle show armadillo")
def show(
    project: Annotated[str, typer.Argument(help="The project; may be left out if there is one only")] = "",
    connect: Connect = "",
    robot: Robot = "",
    runs: Runs = Path("runs"),
    as_json: AsJson = False,
) -> None:
    """Print a project's documents as the registry holds them now."""

    async def ask(client: AosClient) -> ProjectRevision:
        key, query = client.keys.project, ProjectQuery(project)
        return await client.bus.ask(key, query, ProjectRevision, timeout_s=ANSWER_TIMEOUT_S)

    revision = _with_client(connect, robot, runs, ask)
    if as_json:
        _print_json(revision)
        return
    typer.echo(f"revision {revision.revision}, digest {revision.digest}")
    typer.echo(outline(revision.project), nl=False)


def _with_client(connect: str, robot: str, runs: Path, ask: Callable[[AosClient], Awaitable[T]]) -> T:
    """The answer of the system at `connect`, or of the newest run; AosError if there is none."""
    if connect and not robot:
        raise DeployError("which robot?", code="AOS801", hint="Name it with --robot")
    if not connect:
        record = _running(RunDirectory.latest(runs)).read_record()
        connect, robot = record.endpoint, robot or record.robot

    import asyncio  # Only here, as the client: the commands that need no bus start quicker.

    from aos_runtime.client import AosClient

    async def run() -> T:
        async with AosClient.connect(connect, robot) as client:
            return await ask(client)

    return asyncio.run(run())


def _running(directory: RunDirectory) -> RunDirectory:
    if not directory.is_running:
        hint = "Start a system with aos-up, or name a running one with --connect"
        raise DeployError(f"the last run, {directory.path.name}, is over", code="AOS605", hint=hint)
    return directory


# --- output --------------------------------------------------------------------------------------------


def _sentence(report: BundleReport, path: Path) -> str:
    if not report.is_accepted:
        still = f"; the project stays at revision {report.revision}" if report.revision else ""
        return f"{path}: refused{still}"
    changes = {"added": report.added, "changed": report.changed}
    new = [f"{verb} {', '.join(names)}" for verb, names in changes.items() if names]
    return f"{path}: project {report.project}, revision {report.revision}, {'; '.join(new) or 'nothing new'}"


def _print_diagnostics(diagnostics: Iterable[Diagnostic]) -> None:
    for diagnostic in diagnostics:
        typer.echo(render(diagnostic))


def _print_json(value: object) -> None:
    typer.echo(msgspec.json.format(msgspec.json.encode(value), indent=2).decode())


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
