"""`aos bundle`: documents sent to a running registry, and what it holds."""

from pathlib import Path
from typing import Annotated

import typer

from aos_deploy.bundles.files import refusal
from aos_deploy.commands.documents import Folder
from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, grouped
from aos_deploy.printing import print_diagnostics, print_json, time_text
from aos_deploy.running_system import System
from aos_deploy.views.lines import changes_text
from aos_language.load import read_bundle_files
from aos_language.outline import outline
from aos_protocol.diagnostics import has_errors
from aos_protocol.errors import DocumentError
from aos_protocol.messages import BundleReport

bundle_app = typer.Typer(
    name="bundle",
    no_args_is_help=True,
    help="Send documents to a running system, or list them.",
    epilog="Example: aos bundle push deploy/bundles/armadillo-finer",
)


OneProject = Annotated[str, typer.Argument(help="The project; may be left out if there is one only")]


@bundle_app.command(epilog="Example: aos bundle push deploy/bundles/armadillo-finer")
@grouped
def push(system: System, path: Folder, as_json: AsJson = False) -> None:
    """Send a bundle to the registry.

    A new project, new skills, or better documents of old ones.

    A changed document that replaces one with a declared version needs a higher one.

    Exit code 0: accepted, or nothing new. 1: refused; nothing has changed then.
    """
    files, remarks = read_bundle_files(path)
    if has_errors(remarks):
        raise refusal(path, tuple(remarks))
    if not files:
        hint = "Documents end in .ef, .sd, .am, .lf or .json"
        raise DocumentError(f"there are no documents in {path}", code="AOS120", hint=hint)

    report = system.do(lambda client: client.push(files, str(path)))
    if as_json:
        print_json(report)
    else:
        print_diagnostics((*remarks, *report.diagnostics))
        typer.echo(_sentence(report, path))
    if not report.is_accepted:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


@bundle_app.command("list", epilog="Example: aos bundle list")
@grouped
def list_projects(system: System, as_json: AsJson = False) -> None:
    """List the projects that the registry holds, with their skills."""
    catalogue = system.do(lambda aos: aos.catalogue())
    if as_json:
        print_json(catalogue)
        return
    for entry in catalogue.entries:
        stored = time_text(entry.stored_ns)
        typer.echo(f"{entry.project}  revision {entry.revision}  {entry.digest[:12]}  {stored}")
        typer.echo(f"  {', '.join(entry.skills)}")
    if not catalogue.entries:
        typer.echo("The registry holds no projects.")


@bundle_app.command(epilog="Example: aos bundle show armadillo")
@grouped
def show(
    system: System,
    project: OneProject = "",
    number: Annotated[
        int, typer.Option("--revision", min=0, help="An older revision; 0 is the current one")
    ] = 0,
    as_json: AsJson = False,
) -> None:
    """Print a project's documents as the registry holds them."""
    revision = system.do(lambda aos: aos.project(project, number))
    if as_json:
        print_json(revision)
        return
    typer.echo(f"revision {revision.revision}, digest {revision.digest}")
    typer.echo(outline(revision.project), nl=False)


@bundle_app.command(epilog="Example: aos bundle history armadillo")
@grouped
def history(system: System, project: OneProject = "", as_json: AsJson = False) -> None:
    """List a project's revisions.

    When each was stored, and which documents it added, changed or removed.
    """
    found = system.do(lambda aos: aos.revisions(project))
    if as_json:
        print_json(found)
        return
    for entry in found.entries:
        state = entry.digest[:12] if entry.digest else "removed"
        typer.echo(f"{found.project}  revision {entry.revision}  {state}  {time_text(entry.stored_ns)}")
        for sign, names in (("+", entry.added), ("~", entry.changed), ("-", entry.removed)):
            if names:
                typer.echo(f"  {sign} {', '.join(_with_version(name, entry.versions) for name in names)}")


@bundle_app.command("rm", epilog="Example: aos bundle rm armadillo observe_holding")
@grouped
def remove(
    system: System,
    project: Annotated[str, typer.Argument(help="The project")],
    skill: Annotated[str, typer.Argument(help="Only this skill; else the whole project")] = "",
    as_json: AsJson = False,
) -> None:
    """Take a skill, or a whole project, out of the catalogue.

    A mission that runs does without the skill from its next decision on; without the project it goes on with
    what it has. The history keeps what was. Exit code 1: refused, because what is left has mistakes.
    """
    report = system.do(lambda aos: aos.remove(project, skill))
    if as_json:
        print_json(report)
    else:
        print_diagnostics(report.diagnostics)
        typer.echo(_sentence(report, f"{project} {skill}".strip()))
        if report.is_accepted and not skill:
            typer.echo("A mission that runs goes on with the documents it has.")
    if not report.is_accepted:
        raise typer.Exit(ExitCode.DOCUMENTS_WRONG)


def _with_version(name: str, versions: dict[str, str]) -> str:
    return f"{name} ({versions[name]})" if name in versions else name


def _sentence(report: BundleReport, what: Path | str) -> str:
    if not report.is_accepted:
        still = f"; the project stays at revision {report.revision}" if report.revision else ""
        return f"{what}: refused{still}"
    return f"{what}: project {report.project}, revision {report.revision}, {changes_text(report)}"
