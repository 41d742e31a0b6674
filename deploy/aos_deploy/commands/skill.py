"""`aos skill` and `aos resume`: what can be called, calling it by hand, stopping it, and going on."""

import asyncio
import json
import time
from typing import Annotated, Any

import msgspec
import typer

from aos_deploy.options import AsJson, command, grouped, seconds
from aos_deploy.printing import print_json
from aos_deploy.running_system import System
from aos_protocol import messages
from aos_protocol.documents import LocalSource, Project
from aos_protocol.errors import AosError, DeployError, SkillError
from aos_protocol.keys import Serving
from aos_protocol.spelling import did_you_mean, quoted
from aos_runtime.bus.subscription import Subscription
from aos_runtime.client import AosClient
from aos_runtime.parties.served import served

_ASK_S = 5.0
_LAST_S = 0.5
"""The progress of a call that has ended may be under way for so long."""

skill_app = typer.Typer(
    name="skill",
    no_args_is_help=True,
    help="See, call and stop the skills of a running system.",
    epilog="Example: aos skill list, then aos skill call /navigate x=1.5 y=0 yaw=0",
)


@skill_app.command("list", epilog="Example: aos skill list --json")
@grouped
def list_skills(system: System, as_json: AsJson = False) -> None:
    """List the skills with their paths, and who serves them."""

    async def show(aos: AosClient) -> None:
        project, state, servers = await _known(aos)
        rows = [_row(skill.name, skill.mapping.activation.path, state, servers) for skill in project.skills]
        if as_json:
            print_json(rows)
            return
        for row in rows:
            by = ", ".join(row["served_by"]) or row["unavailable"]
            typer.echo(f"{row['skill']:24} {row['path']:24} {by}")

    system.do(show)


@skill_app.command(epilog="Example: aos skill info pick")
@grouped
def info(
    system: System,
    name: Annotated[str, typer.Argument(help="The skill, or its path")],
    as_json: AsJson = False,
) -> None:
    """Tell what a skill's call takes, and what its mapping reads."""

    async def show(aos: AosClient) -> None:
        project, state, servers = await _known(aos)
        skills = {skill.name: skill for skill in project.skills}
        paths = {skill.mapping.activation.path.strip("/"): skill for skill in project.skills}
        skill = skills.get(name) or paths.get(name.strip("/"))
        if skill is None:
            hint = did_you_mean(name, (*skills, *paths)) or f"Known: {', '.join(skills)}"
            raise SkillError(f"there is no skill {name}", code="AOS501", hint=hint)
        mapping = skill.mapping
        topics = {v.topic for v in mapping.local_variables if v.source is LocalSource.TOPIC}
        row = _row(skill.name, mapping.activation.path, state, servers) | {
            "kind": mapping.activation.kind,
            "fields": {field.name: field.value.code for field in mapping.activation.fields},
            "topics": sorted(topics),
            "responses": [rule.response for rule in mapping.rules],
        }
        typer.echo(json.dumps(row, indent=2) if as_json else _lines(row))

    system.do(show)


@skill_app.command(epilog="Example: aos skill call /navigate x=1.5 y=0 yaw=0 --anyway")
@grouped
def call(
    system: System,
    name: Annotated[str, typer.Argument(metavar="PATH", help="The path that somebody serves, or a skill")],
    fields: Annotated[list[str] | None, typer.Argument(help="NAME=VALUE; values are JSON, or texts")] = None,
    deadline: Annotated[float, seconds(least=0.1, help="Seconds that it may take")] = 60.0,
    anyway: Annotated[bool, typer.Option("--anyway", help="Also while the mission moves the robot")] = False,
    as_json: AsJson = False,
) -> None:
    """Call a skill by hand, past mapping and mission; Ctrl-C cancels it.

    The belief does not learn of it.
    """

    async def work(aos: AosClient) -> None:
        state = await _mission_state(aos)
        if state is not None and state.phase in ("planning", "acting") and not anyway:
            hint = "Let it hold or end first, or use --anyway"
            raise DeployError("the mission moves the robot", code="AOS502", hint=hint)
        path = await _served_path(aos, name)
        request = messages.SkillCall(
            messages.ActivationId("by-hand", time.time_ns()), path, _values(fields or []), deadline
        )
        async with aos.bus.listen(aos.keys.progress(path), messages.SkillProgress) as progress:
            telling = asyncio.create_task(_tell(progress, request.id, as_json))
            try:
                result = await aos.bus.ask(
                    aos.keys.call(path), request, messages.SkillResult, timeout_s=deadline + _ASK_S
                )
                await asyncio.wait([telling], timeout=_LAST_S)
            except asyncio.CancelledError:
                await _stop(aos, path, request.id)
                raise
            finally:
                telling.cancel()
        if as_json:
            typer.echo(msgspec.json.encode(result.fields))
        else:  # People see NaN and bytes as they are.
            typer.echo(json.dumps(result.fields, indent=2, default=str))

    system.do(work)


@skill_app.command(epilog="Example: aos skill cancel")
@grouped
def cancel(
    system: System,
    name: Annotated[
        str, typer.Argument(metavar="[PATH]", help="Only what runs there, or that skill; else whatever moves")
    ] = "",
    as_json: AsJson = False,
) -> None:
    """Stop what moves; the mission goes on with that outcome."""

    async def work(aos: AosClient) -> None:
        everything = {server.path for server in await served(aos.bus, aos.keys)}
        paths = [await _served_path(aos, name)] if name else sorted(everything)
        answers = await asyncio.gather(*(_stop(aos, path) for path in paths), return_exceptions=True)
        stopped = {id for answer in answers if isinstance(answer, messages.Cancelled) for id in answer.ids}
        told = f"stopped {', '.join(sorted(stopped))}" if stopped else "nothing was moving"
        typer.echo(json.dumps({"stopped": sorted(stopped)}) if as_json else told)
        for answered in answers:
            if isinstance(answered, AosError) and name:
                raise answered

    system.do(work)


@command("Example: aos resume")
def resume(system: System) -> None:
    """Go on with a mission that holds."""

    async def work(aos: AosClient) -> None:
        before = await aos.mission_state()
        if before.phase == "holding":
            await aos.resume()
            typer.echo("the mission goes on")
        else:
            typer.echo(f"it does not hold: {before.phase}")

    system.do(work)


# --- what they share ---


async def _known(aos: AosClient) -> tuple[Project, messages.MappingState, list[Serving]]:
    revision, state = await aos.project(), await aos.mapping_state()
    return revision.project, state, await served(aos.bus, aos.keys)


async def _served_path(aos: AosClient, name: str) -> str:
    """The path that is named, or that of the skill; SkillError AOS505 where no adapter serves it."""
    paths = {server.path for server in await served(aos.bus, aos.keys)}
    path = "/" + name.strip("/")
    if path in paths:
        return path
    project, _, _ = await _known(aos)
    of_skills = {skill.name: "/" + skill.mapping.activation.path.strip("/") for skill in project.skills}
    path = of_skills.get(name, path)
    if path not in paths:
        hint = did_you_mean(name, (*paths, *of_skills)) or f"Served are {quoted(sorted(paths))}"
        raise SkillError(f"no adapter serves {path}", code="AOS505", hint=hint)
    return path


async def _mission_state(aos: AosClient) -> messages.MissionState | None:
    try:
        return await aos.mission_state()
    except AosError:
        return None


async def _stop(aos: AosClient, path: str, id: messages.ActivationId | None = None) -> messages.Cancelled:
    return await aos.bus.ask(
        aos.keys.cancel(path), messages.Cancel("stopped by hand", id), messages.Cancelled, timeout_s=_ASK_S
    )


async def _tell(
    progress: Subscription[tuple[str, messages.SkillProgress]], id: messages.ActivationId, as_json: bool
) -> None:
    """Prints progress until that of the call's end."""
    async for _, report in progress:
        if as_json:
            typer.echo(msgspec.json.encode(report), err=True)
        else:
            typer.echo(f"{report.state:10} {report.progress:4.0%}  {report.text}", err=True)
        if report.id == id and not report.goes_on:
            return


def _row(skill: str, path: str, state: messages.MappingState, servers: list[Serving]) -> dict[str, Any]:
    path = "/" + path.strip("/")
    return {
        "skill": skill,
        "path": path,
        "served_by": [server.who for server in servers if server.path == path],
        "unavailable": state.unavailable.get(skill, ""),
    }


def _lines(row: dict[str, Any]) -> str:
    lines = []
    for name, value in row.items():
        if isinstance(value, dict):
            value = ", ".join(f"{field} = {code}" for field, code in value.items())
        elif isinstance(value, list):
            value = ", ".join(value)
        if value:
            lines.append(f"{name:12} {value}")
    return "\n".join(lines)


def _values(texts: list[str]) -> dict[str, Any]:
    """Fields from NAME=VALUE; DeployError AOS901 for anything else."""
    values = {}
    for text in texts:
        name, mark, value = text.partition("=")
        if not mark:
            raise DeployError(f"{text!r} is no field", code="AOS901", hint="Write fields as NAME=VALUE")
        try:
            values[name] = json.loads(value)
        except ValueError:
            values[name] = value
    return values
