"""The engine of a bundle, for commands that need no robot."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

import typer

from aos_deploy.bundles.files import Planned, project_at, with_mission
from aos_deploy.bundles.reachability import endless_findings
from aos_deploy.places import cache_dir
from aos_language.follow_ups import told_once
from aos_language.load import with_excerpts
from aos_protocol.diagnostics import Severity, render
from aos_protocol.documents import Constraint, MissionValue
from aos_protocol.errors import ModelError
from aos_solver.building.build import BuildKind
from aos_solver.building.project_build import build_project
from aos_solver.child.engine import Engine

_TOLD_EVERY_S = 3.0
"""So often a command tells how far the engine is."""


@asynccontextmanager
async def engine_of_bundle(
    bundle: Path | Planned,
    seed: int,
    *,
    kind: BuildKind = "quick",
    constraints: Sequence[Constraint] = (),
    values: Sequence[MissionValue] = (),
) -> AsyncIterator[Engine]:
    """The engine of a bundle, compiled if need be, for missions with these constraints and values.

    A deploy file stands for its bundles, and adds its own constraints and values. Mistakes in documents come
    as one DocumentError; faults of the model show the line of the document. Loops that no draw ended are told
    in the end.
    """
    planned, project, found = project_at(bundle)
    # Remarks are for `aos lint`: here they would be told with every run.
    for diagnostic in (finding for finding in found if finding.severity is not Severity.REMARK):
        typer.echo(render(diagnostic), err=True)
    try:
        built = await build_project(
            with_mission(
                project, (*planned.constraints, *constraints), (*planned.values, *values), planned.sources
            ),
            cache_dir(),
            lambda remark: typer.echo(f"aos: {remark}", err=True),
            kind=kind,
        )
        async with await Engine.start(built, seed=seed) as engine:
            engine.on_progress = lambda progress: typer.echo(f"aos: {progress.text}", err=True)
            await engine.tell_progress(_TOLD_EVERY_S)
            yield engine
            for finding in with_excerpts(await endless_findings(engine), planned.files):
                typer.echo(render(finding), err=True)
    except ModelError as error:
        error.diagnostics = told_once(with_excerpts(error.diagnostics, planned.files))
        raise
