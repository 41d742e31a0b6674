"""The deploy file's `programs:`: what runs beside the adapters, such as a simulator or a launch file."""

import re
from collections.abc import Collection
from typing import Annotated, Literal

import msgspec

from aos_deploy.deployment.adapters import how_to_name
from aos_deploy.deployment.hosts import check_host
from aos_deploy.deployment.typed import plain_value
from aos_deploy.deployment.yaml_source import YamlMap
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span

Seconds = Annotated[float, msgspec.Meta(gt=0, le=1e9)]
Port = Annotated[int, msgspec.Meta(ge=1, le=65535)]
Status = Annotated[int, msgspec.Meta(ge=0, le=255)]


class ReadyPart(msgspec.Struct, frozen=True, kw_only=True):
    """The sign that a program is ready; one of these.

    A TCP `port` of the `address` takes connections. A `line` of what it prints matches a regular expression.
    A `file` was made or written since its start. A `command` succeeds, which is tried again and again. So
    many `seconds` are over. The program has ended with the status `exit`: then it is done, and not watched.
    """

    port: Port | None = None
    address: str = "localhost"
    line: str | None = None
    file: str | None = None
    command: tuple[str, ...] = ()
    seconds: Seconds | None = None
    exit: Status | None = None

    @property
    def kinds(self) -> list[str]:
        """The names of the fields that are given."""
        kinds = ("port", "line", "file", "command", "seconds", "exit")
        return [kind for kind in kinds if getattr(self, kind) not in (None, ())]

    def __str__(self) -> str:
        if self.port is not None:
            return f"nothing takes connections at {self.address}:{self.port}"
        if self.line is not None:
            return f"it has printed no line that matches {self.line}"
        if self.file is not None:
            return f"it has not written the file {self.file}"
        if self.command:
            return f"the command {' '.join(self.command)} does not succeed"
        return f"it has not ended with status {self.exit}" if self.exit is not None else "it is still young"


class ProgramPart(msgspec.Struct, frozen=True, kw_only=True):
    """A program that is no adapter: started before the adapters, stopped after them.

    The adapters start when it is `ready`, for which it may take `start_s`; without `ready` that is at once.
    It gets SIGTERM, and after `stop_s` SIGKILL. `on_exit` says what follows when it ends by itself: `fault`
    ends the run, `restart` starts it again, three times at most, `ignore` goes on without it. With a `host`
    it runs there, in a `folder` of that host.
    """

    command: tuple[str, ...]
    ready: ReadyPart | None = None
    start_s: Seconds = 60.0
    stop_s: Seconds = 10.0
    on_exit: Literal["fault", "restart", "ignore"] = "fault"
    host: str = ""
    folder: str = ""


def check_programs(
    programs: dict[str, ProgramPart], node: YamlMap, findings: Findings, adapters: Collection[str]
) -> None:
    """Adds findings about what the types alone cannot say. `adapters` are the names of adapters."""
    given = node.entries.get("programs")
    places = given.keys if isinstance(given, YamlMap) else {}
    for name, part in programs.items():
        where = places[name]
        if hint := how_to_name(name, adapters):
            findings.error("AOS126", f"{name!r} is no name for a program", where, hint)
        if not part.command:
            hint = "Write it as programs: {NAME: {command: [PROGRAM, ARGUMENT]}}"
            findings.error("AOS106", f"programs.{name}.command names no program", where, hint)
        check_host(f"programs.{name}", part.host or None, part.folder, where, findings)
        if part.ready is not None:
            given_ready = plain_value(given).get(name, {}).get("ready") if given is not None else None
            _check_ready(name, part, part.ready, where, findings, is_empty=not given_ready)


def _check_ready(
    name: str, part: ProgramPart, ready: ReadyPart, where: Span, findings: Findings, *, is_empty: bool
) -> None:
    kinds = ready.kinds
    if len(kinds) > 1 or is_empty:  # What is wrong in other ways has been told.
        hint = "Give it one of port, line, file, command, seconds, exit"
        said = " and ".join(kinds) or "nothing"
        findings.error("AOS106", f"programs.{name}.ready says {said}", where, hint)
    if ready.line is not None:
        try:
            re.compile(ready.line)
        except (re.error, RecursionError, OverflowError) as error:
            message = f"programs.{name}.ready.line is no regular expression: {error}"
            findings.error("AOS106", message, where, "In YAML put it into single quotes: '...'")
    is_seen_there = kinds == ["file"] or (kinds == ["port"] and ready.address == "localhost")
    if part.host and is_seen_there:
        message = f"programs.{name}.ready.{kinds[0]} is looked for on this machine, not on {part.host}"
        findings.error("AOS106", message, where, "Use a line of its output, or give the port's address")
    if ready.exit is not None and part.on_exit != "fault":
        message = f"programs.{name} is to end, and on_exit says {part.on_exit}"
        findings.error("AOS106", message, where, "Leave on_exit out: another status ends the run")
