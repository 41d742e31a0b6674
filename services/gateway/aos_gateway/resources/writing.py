"""The operations that change something: checks, missions, bundles. Each needs the token."""

import asyncio
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from aos_deploy.deployment.folder import deploy_files_in
from aos_deploy.deployment.reading import read_deploy_file
from aos_gateway.runs.run import Run, RunEntry
from aos_gateway.runs.starting import StartedRun, start_system
from aos_gateway.runs.uploads import ProjectEntry, files_of_upload, keep_project, kept_projects
from aos_gateway.shared import Gateway
from aos_language.follow_ups import told_once
from aos_language.load import LoadedBundle, load_files, with_excerpts
from aos_protocol.access import OPERATOR
from aos_protocol.diagnostics import Diagnostic, has_errors
from aos_protocol.errors import DocumentError, GatewayError
from aos_protocol.messages import BundleReport, MissionState, Steer, SteeringVerb


class Report(msgspec.Struct, frozen=True):
    """The findings of a check. A bundle without errors has a `digest`; its project and skills are named."""

    is_accepted: bool
    project: str
    skills: tuple[str, ...]
    digest: str
    diagnostics: tuple[Diagnostic, ...]


class Projects(msgspec.Struct, frozen=True):
    """The projects that can be started."""

    projects: tuple[ProjectEntry, ...]


class Named(msgspec.Struct, frozen=True):
    """The name of an uploaded file, whose ending says what it is."""

    name: Annotated[str, msgspec.Meta(min_length=1, max_length=200)] = "bundle.zip"


class StartSystem(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A system to start with `aos-up`: the path of a deploy file, or the name of a project.

    With `model` every skill is played by its own document. With `stay` the system goes on after its mission.
    """

    project: str = ""
    deploy_file: str = ""
    seed: Annotated[int, msgspec.Meta(ge=0, le=2**63 - 1)] | None = None
    model: bool = False
    stay: bool = False
    values: dict[str, str] = {}


class NextMission(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The next mission of a system that stays; as in StartMission."""

    belief: Literal["initial", "keep"] = "initial"
    given: tuple[str, ...] = ()
    idle: Annotated[int, msgspec.Meta(ge=0, le=10_000)] = 0
    values: dict[str, str] = {}


class Steering(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The wish of an operator, as in Steer. Without `by` it is the user of the gateway."""

    verb: SteeringVerb
    actions: tuple[str, ...] = ()
    name: str = ""
    by: str = ""
    reason: str = ""


async def projects(gateway: Gateway) -> Projects:
    """The projects that can be started: deploy files in the gateway's folders, and bundles that were
    uploaded."""
    return Projects(await asyncio.to_thread(_projects, gateway))


async def upload(gateway: Gateway, query: Named, body: bytes) -> ProjectEntry:
    """Keep a bundle as a project whose skills are played by their own documents.

    The body is an archive of documents. A deploy file in it is left out: adapters own hardware.
    """
    files, loaded = await _loaded(query.name, body)
    if loaded.project is None:
        raise _refused(query.name, told_once(with_excerpts(loaded.diagnostics, files)))
    return await asyncio.to_thread(keep_project, gateway.folder, loaded.project.name, files)


async def check(gateway: Gateway, query: Named, body: bytes) -> Report:
    """Check a bundle, as `aos lint --no-compile` does. The body is an archive of documents, or one
    document."""
    files, loaded = await _loaded(query.name, body)
    found = told_once(with_excerpts(loaded.diagnostics, files))
    project = loaded.project
    skills = tuple(skill.name for skill in project.skills) if project is not None else ()
    name = project.name if project is not None else ""
    return Report(project is not None, name, skills, loaded.digest, found)


async def start(gateway: Gateway, body: StartSystem) -> StartedRun:
    """Start a system and its first mission. Answered once its run is there; the documents may still be
    refused."""
    if bool(body.project) is bool(body.deploy_file):
        raise GatewayError("name either a project or a deploy file", code="AOS901")
    if body.deploy_file:
        path = Path(body.deploy_file)
    else:
        known = {entry.project: entry for entry in await asyncio.to_thread(_projects, gateway)}
        if body.project not in known:
            raise GatewayError(f"there is no project {body.project}", hint="GET /v1/projects lists them")
        path = Path(known[body.project].deploy_file)
    await asyncio.to_thread(read_deploy_file, path)  # What is wrong with it is told here, with its place.
    options = [*(["--model"] if body.model else []), *(["--stay"] if body.stay else [])]
    options += ["--seed", str(body.seed)] if body.seed is not None else []
    options += [f"--set={name}={text}" for name, text in sorted(body.values.items())]
    return await start_system(gateway.shelf, path, gateway.runs, options)


async def end(gateway: Gateway, run: str) -> RunEntry:
    """End a system in order, as Ctrl-C in its terminal does. Answered when it has ended."""
    found = gateway.shelf.run(run)
    await found.end()
    return await found.entry()


async def start_next(gateway: Gateway, run: str, body: NextMission) -> MissionState:
    """Begin the next mission of a system that stays."""
    async with gateway.shelf.run(run).asking(OPERATOR) as client:
        return await client.start_mission(
            belief=body.belief, given=body.given, idle=body.idle, values=body.values
        )


async def stop(gateway: Gateway, mission: str) -> MissionState:
    """Cancel what moves and end a mission as `cancelled`. Answered when it has ended."""
    found = await gateway.shelf.run_of_mission(mission)
    async with found.asking(OPERATOR) as client:
        return await client.stop_mission(mission)


async def steer(gateway: Gateway, mission: str, body: Steering) -> MissionState:
    """Steer a mission that runs: hold, step, resume, stop, act, script, leave_out, take_back."""
    found = await gateway.shelf.run_of_mission(mission)
    async with found.asking(OPERATOR) as client:
        return await client.carry_out(
            Steer(body.verb, body.actions, body.name, body.by or client.by, mission, reason=body.reason)
        )


async def push(gateway: Gateway, run: str, query: Named, body: bytes) -> BundleReport:
    """Give a running system new or better documents. The body is an archive of documents, or one document."""
    found: Run = gateway.shelf.run(run)
    files, remarks = await asyncio.to_thread(files_of_upload, query.name, body)
    if has_errors(remarks) or not files:
        raise _refused(query.name, tuple(remarks))
    async with found.asking(OPERATOR) as client:
        report = await client.push(files, query.name)
    if not report.is_accepted:
        raise _refused(query.name, report.diagnostics)
    return report


def _projects(gateway: Gateway) -> tuple[ProjectEntry, ...]:
    found = list(kept_projects(gateway.folder))
    for folder in gateway.projects:
        for inside in (
            folder,
            folder / "deploy",
            *(path for path in sorted(folder.iterdir()) if path.is_dir()),
        ):
            if inside.is_dir():
                files = (file for file, _ in deploy_files_in(inside))
                found += [ProjectEntry(file.stem, str(file), is_uploaded=False) for file in files]
    return tuple({entry.deploy_file: entry for entry in found}.values())


async def _loaded(name: str, body: bytes) -> tuple[dict[str, bytes], LoadedBundle]:
    """Returns the files of an upload, and the bundle that they are."""
    files, remarks = await asyncio.to_thread(files_of_upload, name, body)
    return files, await asyncio.to_thread(load_files, files, name=name, remarks=remarks)


def _refused(name: str, found: tuple[Diagnostic, ...]) -> DocumentError:
    first = next((diagnostic for diagnostic in found if diagnostic.is_error), None)
    text = f"the bundle {name} is refused" if found else f"there are no documents in {name}"
    return DocumentError(text, code="AOS120", hint=first.message if first else "", diagnostics=found)
