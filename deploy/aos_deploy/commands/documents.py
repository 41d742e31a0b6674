"""`aos lint` and `aos inspect`: documents checked and looked at, without a running system."""

from __future__ import annotations

from collections import Counter
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.printing import count, print_diagnostics, print_json
from aos_protocol.diagnostics import Diagnostic, Severity
from aos_protocol.documents import Project
from aos_protocol.errors import DocumentError
from aos_registry.load import load_bundle
from aos_registry.outline import outline

__all__ = ["Folder", "refusal", "register"]


class Format(StrEnum):
    TEXT = "text"
    JSON = "json"


class Stage(StrEnum):
    DOCUMENTS = "documents"
    MODEL = "model"
    CPP = "cpp"
    PYTHON = "python"


Folder = Annotated[
    Path, typer.Argument(metavar="DIR", help="A directory with .ef, .sd, .am or .json documents")
]


def register(app: typer.Typer) -> None:
    """Adds the commands to `aos`."""
    app.command(epilog="Example: aos lint deploy/bundles/armadillo-finer")(lint)
    app.command(epilog="Example: aos inspect deploy/bundles/armadillo-finer --stage documents")(inspect)


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
        print_json(
            {
                "bundle": str(path),
                "errors": counts[Severity.ERROR],
                "warnings": counts[Severity.WARNING],
                "digest": loaded.digest,
                "diagnostics": loaded.diagnostics,
            }
        )
    else:
        print_diagnostics(loaded.diagnostics)
        errors, warnings = counts[Severity.ERROR], counts[Severity.WARNING]
        typer.echo(f"{path}: {count(errors, 'error')}, {count(warnings, 'warning')}")
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
        raise refusal(bundle, loaded.diagnostics)
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
        raise refusal(bundle, diagnostics)
    if stage is Stage.CPP:
        return emit(program).cpp
    return msgspec.json.format(msgspec.json.encode(program), indent=2).decode() + "\n"


def refusal(bundle: Path, diagnostics: tuple[Diagnostic, ...]) -> DocumentError:
    """What is raised for a bundle with errors."""
    hint = "Mend the places named above"
    return DocumentError(f"{bundle} has errors", code="AOS120", hint=hint, diagnostics=diagnostics)
