"""A program of the system as a process: its settings written, its output in the run's log.

Logs are kept from filling the disk by a program that prints without end.
"""

import asyncio
import os
import re
import shlex
import shutil
from contextlib import suppress
from pathlib import Path

from msgspec.structs import replace

from aos_deploy.processes.passes import Passes
from aos_deploy.processes.program import Program, settings_of
from aos_deploy.processes.remote import check_ssh, dialled, remote_command
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.errors import DeployError
from aos_runtime.bus.credentials import PASSWORD_FILE_VARIABLE, USER_VARIABLE
from aos_runtime.failpoints import reach
from aos_runtime.processes.children import PIPE, Child, Limits, guarded
from aos_runtime.processes.settings import ServiceSettings

ROUTER_MODULE = "aos_runtime.router"


async def start_process(program: Program, base: ServiceSettings, run: RunDirectory, passes: Passes) -> Child:
    """The process. `base` says robot, endpoint, run directory, and `passes` has its credential.

    DeployError AOS802 if it cannot be started.
    """
    reach("up.start.before")
    password = "" if program.module == ROUTER_MODULE else str(passes.file(program.user))
    own = replace(base, service=program.name, password_file=password)
    settings = run.write_settings(program.name, settings_of(program, own))
    environment = {"AOS_ENDPOINT": base.endpoint, "AOS_ROBOT": base.robot, "PYTHONUNBUFFERED": "1"}
    environment |= {USER_VARIABLE: program.user, PASSWORD_FILE_VARIABLE: password}
    if not program.is_own:
        environment |= {"AOS_SETTINGS": str(settings), "AOS_ADAPTER": program.name}
    with run.open_log(program.name) as log:
        if program.host:
            check_ssh(program.name, program.host)
            dial = await asyncio.to_thread(dialled, program.host)
            command = remote_command(program, base.endpoint, environment, settings, dial)
            # Its input stays open: when that ends, so does the program over there.
            child = await Child.start(
                guarded(command, Limits(grace_s=program.stop_s)),
                name=program.name,
                stdin=PIPE,
                stdout=log,
                stderr=log,
            )
            # Command lines can be read by everybody on a machine, what goes through a pipe cannot.
            child.stdin.write(f"{passes.credential(program.user).password}\n".encode())
            return child
        return await Child.start(
            program.argv(settings),
            name=program.name,
            cwd=program.folder,
            env=environment if program.command else None,
            stdout=log,
            stderr=log,
        )


_WHERE = "Paths of commands are relative to the deploy file's folder"


def check_command(name: str, command: tuple[str, ...], folder: Path) -> None:
    """Raises DeployError AOS802 if the first word of a command names nothing that can be started in the
    folder."""
    program = command[0]
    is_python = re.fullmatch(r"python[0-9.]*", Path(program).name)
    if is_python and command[1:] and command[1].endswith(".py") and not (folder / command[1]).is_file():
        raise DeployError(f"{name}: there is no file {command[1]} in {folder}", code="AOS802", hint=_WHERE)
    if program == "python":
        return
    path = folder / program
    if "/" not in program:
        if shutil.which(program) is None:
            near = f"Write ./{program} for the one in {folder}" if path.is_file() else "Name it by its path"
            raise DeployError(f"{name}: there is no program {program} on the PATH", code="AOS802", hint=near)
    elif not path.is_file():
        raise DeployError(f"{name}: there is no program {program} in {folder}", code="AOS802", hint=_WHERE)
    elif not os.access(path, os.X_OK):
        interpreter = "bash" if path.suffix == ".sh" else "python"
        command_line = f"chmod +x {shlex.quote(str(path))}"
        hint = f"Run {command_line}, or name the interpreter first: [{interpreter}, {program}]"
        raise DeployError(f"{name}: the program {path} may not be executed", code="AOS802", hint=hint)


LOG_BYTES = 256 * 1024**2
"""A log that has become longer is cut."""
KEPT_BYTES = 1024**2
"""The end of a log that is left when it is cut."""
EVERY_S = 1.0


async def keep_logs_short(folder: Path) -> None:
    """Cuts the logs in a folder as they become too long, until it is cancelled."""
    while True:
        await asyncio.sleep(EVERY_S)
        await asyncio.to_thread(shorten_all, folder)


def shorten_all(folder: Path) -> None:
    """Cuts the logs in a folder that are too long."""
    with suppress(OSError):  # The next time will do.
        for log in folder.glob("*.log"):
            shorten(log)


def shorten(log: Path, *, most_bytes: int = LOG_BYTES, kept_bytes: int = KEPT_BYTES) -> None:
    """Cuts a log of more than `most_bytes` to a line that says so, and its last lines.

    Whoever writes it adds to its end, as files do that are opened for that. What is written in between is
    lost.
    """
    size = log.stat().st_size
    if size <= most_bytes:
        return
    with log.open("r+b") as file:
        file.seek(size - kept_bytes)
        end = file.read(kept_bytes).partition(b"\n")[2]
        file.truncate(0)
    with log.open("ab") as file:
        file.write(b"aos-up: this log had %d bytes, and was cut to its end\n" % size + end)
