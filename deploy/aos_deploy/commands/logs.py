"""`aos logs`: the logs of a run, as they are or as they grow."""

import os
import time
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from aos_deploy.options import Run, Runs, command
from aos_deploy.printing import from_here
from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.living import chosen_run
from aos_protocol.errors import DeployError
from aos_protocol.spelling import did_you_mean

_END_BYTES = 1024**2
"""The part of a longer log that is read."""
_LOOK_S = 0.2


@command("Example: aos logs solver pybullet --follow")
def logs(
    services: Annotated[
        list[str] | None, typer.Argument(metavar="SERVICE...", help="Services, adapters, programs; else all")
    ] = None,
    run: Run = None,
    runs: Runs = None,
    lines: Annotated[int, typer.Option("--lines", "-n", min=0, help="The last lines of each")] = 20,
    follow: Annotated[bool, typer.Option("--follow", "-f", help="Go on until the run is over")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a line")] = False,
) -> None:
    """Print the logs of a run.

    Each line begins with the name of its service. What the functions of an adapter print is in its log. The
    error output names the run.
    """
    directory = chosen_run(run, runs)
    _refuse_unknown(services or [], directory)
    typer.echo(f"Logs of {from_here(directory.named)}", err=True)
    shown: dict[Path, _Log] = {}
    is_first = goes_on = True
    while goes_on:
        goes_on = follow and directory.is_held  # Before the logs are read: they are complete then.
        for path in _logs_of(directory):
            if services and path.stem not in services:
                continue
            if path not in shown:
                shown[path] = _Log(path)
            new = shown[path].new_lines(is_last=not goes_on)
            for line in new[max(0, len(new) - lines) :] if is_first else new:
                told = {"service": path.stem, "line": line}
                typer.echo(msgspec.json.encode(told) if as_json else f"{path.stem} | {line}")
        is_first = False
        if goes_on:
            time.sleep(_LOOK_S)


class _Log:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._at = max(0, path.stat().st_size - _END_BYTES)
        self._begun = b""

    def new_lines(self, *, is_last: bool) -> list[str]:
        """Returns lines that ended since the last call, and where it `is_last` also the one that has not.

        Of a log that was cut since then, only what comes from now on.
        """
        with self._path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(min(self._at, size))
            text = self._begun + file.read()
            self._at = file.tell()
        *ended, self._begun = text.split(b"\n")
        if is_last and self._begun:
            ended.append(self._begun)
        return [line.decode(errors="replace") for line in ended]


def _logs_of(run: RunDirectory) -> list[Path]:
    return sorted((run.path / "logs").glob("*.log"))


def _refuse_unknown(services: list[str], run: RunDirectory) -> None:
    known = [path.stem for path in _logs_of(run)]
    for name in services:
        if name not in known:
            hint = f"{did_you_mean(name, known)} It has {', '.join(known)}".strip()
            raise DeployError(f"the run {run.path.name} has no log of {name}", code="AOS901", hint=hint)
