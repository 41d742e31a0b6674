"""Programs on other hosts: started, awaited and stopped through ssh, which also carries the bus to them.

The router listens on this machine alone. ssh gives the other host a port on its own loopback that leads to
it: nothing of the bus is open to a network, and ssh encrypts what goes over one.

ssh dials by itself only where the user's own configuration says how; else `ssh_connection.py` does, which
finds a host sooner that comes back.
"""

import random
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from aos_deploy.processes import ssh_connection
from aos_deploy.processes.program import Program
from aos_protocol.errors import DeployError

_SSH_FAILED = 255
_NOT_FOUND = 127
_FROZEN = 147
"""128 and SIGSTOP: the program was frozen, and was killed when we asked."""
_PORTS = (20_000, 32_000)
_OPTIONS = (
    "BatchMode=yes",  # It asks nothing: nobody is there to answer.
    "ExitOnForwardFailure=yes",
    "ControlPath=none",  # A connection that others share is not known to be lost so soon.
    # Short attempts, and several: a host that comes back is seen within seconds.
    "ConnectTimeout=3",
    "ConnectionAttempts=4",
    "ServerAliveInterval=1",
    "ServerAliveCountMax=3",  # It ends 3 to 4 s after it has last heard of the host.
)
_PATIENT = "ServerAliveCountMax=5"
"""TCP ends a connection that we have made, just after it has tried once more. ssh would end it just before,
and a new one takes longer than the old one takes to go on. Of two values ssh takes the first."""
_DIALS = ("proxycommand", "proxyjump", "bindaddress", "bindinterface")
_KNOWN_S = 5.0
_NO_NEWS = ("mm_receive_fd: ", "proxy dialer did not pass back a connection")
"""Lines of an ssh whose connection could not be made, after the one that says why."""

# It ends the program when its own input ends, that is with the connection, however that ends. Each line of
# input asks whether a signal has stopped the program, or a process of its session; then it is killed.
_SCRIPT = """\
exec 3<&0
IFS= read -r password <&3
cd {folder} || exit {not_found}
command -v {program} >/dev/null || {{
    echo "there is no program "{program}" in $(pwd) or on the PATH" >&2
    exit {not_found}
}}
AOS_SETTINGS=$(mktemp) && AOS_PASSWORD_FILE=$(mktemp) || exit 1
trap 'rm -f "$AOS_SETTINGS" "$AOS_PASSWORD_FILE"' EXIT
printf %s {settings} >"$AOS_SETTINGS" && printf '%s\\n' "$password" >"$AOS_PASSWORD_FILE" || exit 1
password=
export AOS_SETTINGS AOS_PASSWORD_FILE {environment}
own_group=; target=; command -v setsid >/dev/null && {{ own_group=setsid; target=-; }}
frozen=; trap frozen=1 USR1
$own_group {command} </dev/null 3<&- & program=$!
{{
    while read -r look <&3; do
        grep -qsE "^$program .*\\) T |\\) T [0-9]+ [0-9]+ $program " /proc/[0-9]*/stat || continue
        kill -s USR1 $$
        kill -s KILL -- $target$program
    done
    kill -s TERM -- $target$program
    sleep {grace}
    kill -s KILL -- $target$program
}} >/dev/null 2>&1 &
wait $program; status=$?
[ -z "$frozen" ] || {{ wait $program; status={frozen}; }}
kill $! 2>/dev/null
exit $status
"""

_HINTS = {
    "Permission denied": "Give {host} a key of this user (ssh-copy-id {host}): aos-up types no passwords",
    "Host key verification failed": "Connect once by hand, and look at the key that {host} shows: ssh {host}",
    "forwarding failed": "{host} has to let the bus through: AllowTcpForwarding in its sshd_config",
}


def check_ssh(adapter: str, host: str) -> None:
    """Raises DeployError AOS805 if this machine has no ssh."""
    if shutil.which("ssh") is None:
        message = f"the adapter {adapter} is to run on {host}, and there is no program ssh here"
        hint = "Install an SSH client, such as Debian's openssh-client"
        raise DeployError(message, code="AOS805", hint=hint)


def dialled(host: str) -> list[str]:
    """The options of an ssh that has its connection made; none where its configuration has its own way."""
    try:
        known = subprocess.run(
            ["ssh", "-G", host], capture_output=True, text=True, check=True, timeout=_KNOWN_S
        ).stdout.splitlines()
    except (OSError, subprocess.SubprocessError):
        return []
    if any(line.startswith(_DIALS) for line in known) or "addressfamily any" not in known:
        return []
    command = shlex.join([sys.executable, "-I", "-S", ssh_connection.__file__]).replace("%", "%%")
    options = (f"ProxyCommand={command} %h %p", "ProxyUseFdpass=yes", _PATIENT)
    return [word for option in options for word in ("-o", option)]


def remote_command(
    program: Program, endpoint: str, variables: Mapping[str, str], settings: Path, dialled: list[str]
) -> list[str]:
    """The ssh that runs a program on its host until its input ends. Its first line is the password.

    `dialled` are options for its connection. The command finds `variables`, with the bus's port on its own
    side, settings and password in files.
    """
    port = random.SystemRandom().randrange(*_PORTS)
    environment = {**variables, "AOS_ENDPOINT": f"tcp/127.0.0.1:{port}"}
    for file in ("AOS_SETTINGS", "AOS_PASSWORD_FILE"):
        environment.pop(file, None)
    first, *arguments = program.command
    first = "python3" if first == "python" else first
    script = _SCRIPT.format(
        folder=shlex.quote(program.folder) if program.folder else '"$HOME"',
        program=shlex.quote(first),
        not_found=_NOT_FOUND,
        frozen=_FROZEN,
        settings=shlex.quote(settings.read_text(encoding="utf-8")),
        environment=" ".join(f"{name}={shlex.quote(value)}" for name, value in environment.items()),
        command=shlex.join([first, *arguments]),
        grace=max(1, round(program.stop_s)),
    )
    options = [word for option in _OPTIONS for word in ("-o", option)]
    here = endpoint.partition("/")[2]
    return [
        "ssh",
        "-T",
        *dialled,
        *options,
        "-R",
        f"127.0.0.1:{port}:{here}",
        program.host,
        f"exec sh -c {shlex.quote(script)}",
    ]


def is_lost(program: Program, status: int) -> bool:
    """Says whether it was the connection to a program's host that ended, as far as ssh tells."""
    return bool(program.host) and status == _SSH_FAILED


def was_frozen(program: Program, status: int) -> bool:
    """Says whether the other host has killed a program because it was frozen when we asked."""
    return bool(program.host) and status == _FROZEN


def why_it_failed(name: str, host: str, status: int, said: list[str]) -> DeployError | None:
    """The error behind the end of an ssh that said some last lines; None if the program itself ended."""
    news = [line for line in said if not line.startswith(_NO_NEWS)]
    text = news[-1] if news else ""
    if status == _NOT_FOUND:
        return DeployError(
            f"{name} on {host}: {text}",
            code="AOS802",
            hint="Name the program as that host has it, and its `folder:` there, by default the login's home",
        )
    if status != _SSH_FAILED:
        return None
    hint = next((meaning for sign, meaning in _HINTS.items() if any(sign in line for line in said)), "")
    return DeployError(
        f"{name}: {host} cannot be reached by ssh: {text or 'it says nothing'}",
        code="AOS802",
        hint=(hint or "See that it works by hand, without a password: ssh {host} true").format(host=host),
    )
