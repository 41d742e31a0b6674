"""The build of a project: lowered, emitted, compiled, with the values of its mission parameters."""

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from msgspec.structs import replace

from aos_language.mission_parameters import usable_values
from aos_protocol.diagnostics import Diagnostic, has_errors
from aos_protocol.documents import Project
from aos_protocol.errors import ModelError
from aos_solver.building.build import BuildKind, BuiltModel, build
from aos_solver.emission.emit import EmittedModel, emit
from aos_solver.emission.lowering.lower import lower
from aos_solver.emission.program import Program


async def build_project(
    project: Project,
    cache_dir: Path,
    on_progress: Callable[[str], None] = lambda text: None,
    *,
    kind: BuildKind = "quick",
) -> BuiltModel:
    """Lower, emit and compile; ModelError with all diagnostics if the documents have mistakes.

    Engines get the project's mission values when they are started: another value compiles nothing.
    DocumentError AOS146 for a value that no parameter can have.
    """
    emitted = emitted_model(replace(project, mission_values=()))
    values = usable_values(project.mission_values, emitted.parameters)
    built = await build(emitted, cache_dir=cache_dir, on_progress=on_progress, kind=kind)
    return replace(built, mission_values=values)


@lru_cache(maxsize=8)
def lowered(project: Project) -> tuple[Program | None, tuple[Diagnostic, ...]]:
    """Lowers a project and remembers the result: whoever checks documents builds them as well."""
    return lower(project)


@lru_cache(maxsize=8)
def emitted_model(project: Project) -> EmittedModel:
    """The C++ of a project; ModelError as from `build_project`.

    The result is remembered: documents are checked before they are used, and a change may be taken back.
    """
    program, diagnostics = lowered(project)
    if program is None or has_errors(diagnostics):
        message = f"the documents of {project.name} have mistakes"
        raise ModelError(message, hint="Mend the places named above", diagnostics=tuple(diagnostics))
    return emit(program)
