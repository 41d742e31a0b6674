"""`aos doctor`: what this machine has, and what it lacks."""

import os
import platform
import shutil
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Annotated, Literal

import msgspec
import typer

from aos_deploy.exit_codes import ExitCode
from aos_deploy.options import AsJson, command
from aos_deploy.places import cache_dir
from aos_deploy.printing import print_json
from aos_protocol.errors import AosError
from aos_runtime.distribution import pip_install, version_of
from aos_runtime.processes.sandbox_trial import what_a_confined_program_can
from aos_runtime.sandbox.support import sandbox_support

_PACKAGES = ("eclipse-zenoh", "msgspec", "numpy", "tree-sitter", "rich")
_SIMULATOR = "pybullet"
_SUGGESTED_MEMORY_GB = 2.0
_LOOPBACK_TIMEOUT_S = 2.0
_VERSION_TIMEOUT_S = 60.0


class Finding(msgspec.Struct, frozen=True):
    """One thing a system needs (`missing` if it is not there) or can use (`absent`), and what to do."""

    subject: str
    state: Literal["ok", "absent", "missing"]
    found: str
    advice: str = ""


@command("Example: aos doctor; aos doctor deploy/armadillo.yaml")
def doctor(
    deploy: Annotated[
        Path | None, typer.Argument(metavar="DEPLOY", help="A deploy file, whose needs are looked at, too")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Say what this machine has and lacks.

    With a deploy file also what its robot needs; each lack comes with what to do. Exit code 0: a mission can
    run here. 3: something is missing.
    """
    findings = examine_machine()
    if deploy is not None:
        findings += examine_needs(deploy)
    if as_json:
        print_json(findings)
    else:
        marks = {"ok": "ok     ", "absent": "-      ", "missing": "MISSING"}
        for finding in findings:
            typer.echo(f"{marks[finding.state]}  {finding.subject:14}  {finding.found}")
            if finding.advice:
                typer.echo(f"{'':25}{finding.advice}")
    if any(finding.state == "missing" for finding in findings):
        raise typer.Exit(ExitCode.NOT_STARTED)


def examine_machine() -> list[Finding]:
    """Everything a mission on this machine needs or can use."""
    return [
        _python(),
        *(_package(name) for name in _PACKAGES),
        _simulator(),
        _compiler(),
        _loopback(),
        _processors(),
        _memory(),
        _cache(),
        _sandbox(),
    ]


def examine_needs(deploy: Path) -> list[Finding]:
    """Looks at each need of a deploy file's adapters and programs here; DeployError AOS801 if the file has
    errors."""
    from aos_deploy.deployment.reading import read_deploy_file
    from aos_deploy.processes.needed_here import needs_of

    findings = []
    for name, what, check in needs_of(read_deploy_file(deploy)):
        try:
            check()
        except AosError as error:
            findings.append(Finding(name, "missing", error.message, error.hint))
        else:
            findings.append(Finding(name, "ok", what))
    return findings


def _python() -> Finding:
    found = f"{platform.python_version()} at {sys.executable}"
    if sys.platform != "linux":
        return Finding("system", "missing", sys.platform, "AOS runs on Linux")
    return Finding("python", "ok", f"{found}, {platform.system()} {platform.release()}")


def _package(name: str) -> Finding:
    found = version_of(name)
    if not found:
        return Finding(name, "missing", "not installed", f"Run {pip_install()}")
    return Finding(name, "ok", found)


def _simulator() -> Finding:
    """Real robots and robots simulated by their own documents need none."""
    found = version_of(_SIMULATOR)
    if not found:
        advice = f"Only simulated rooms need it: {pip_install('sim')}"
        return Finding(_SIMULATOR, "absent", "not installed", advice)
    return Finding(_SIMULATOR, "ok", found)


def _compiler() -> Finding:
    """The first of $CXX, g++, clang++ that says its version, else the ziglang wheel."""
    for name in (os.environ.get("CXX", ""), "g++", "clang++"):
        path = shutil.which(name.split()[0]) if name.split() else None
        line = _first_line([path, "--version"]) if path else ""
        if path and line:
            return Finding("C++ compiler", "ok", f"{line} at {path}")
    ziglang = version_of("ziglang")
    if ziglang:
        return Finding("C++ compiler", "ok", f"ziglang {ziglang}, from the Python package")
    advice = f"Install g++ (apt-get install g++), or one from the package index: {pip_install('compiler')}"
    return Finding("C++ compiler", "missing", "none of $CXX, g++, clang++, ziglang", advice)


def _first_line(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_VERSION_TIMEOUT_S)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.partition("\n")[0] if done.returncode == 0 else ""


def _loopback() -> Finding:
    try:
        with socket.create_server(("127.0.0.1", 0)) as server:
            port = server.getsockname()[1]
            # Where the interface is down one can listen, and nobody comes through.
            socket.create_connection(("127.0.0.1", port), _LOOPBACK_TIMEOUT_S).close()
    except OSError as error:
        advice = "`bus: {listen: ...}` and the page need it: ip link set lo up"
        found = f"127.0.0.1 cannot be reached: {error.strerror or error}"
        return Finding("loopback", "absent", found, advice)
    return Finding("loopback", "ok", f"can be reached, port {port} was free")


def _processors() -> Finding:
    cores = len(os.sched_getaffinity(0))
    advice = "" if cores > 1 else "It works, but the planner and the world share the one"
    return Finding("processors", "ok", str(cores), advice)


def _memory() -> Finding:
    try:
        text = Path("/proc/meminfo").read_text(encoding="ascii")
    except OSError:
        return Finding("memory", "absent", "unknown")
    fields = dict(line.split(":", 1) for line in text.splitlines())
    available_gb = int(fields["MemAvailable"].split()[0]) / 2**20
    advice = "" if available_gb >= _SUGGESTED_MEMORY_GB else "The simulated world needs about 1 GB"
    return Finding("memory", "ok", f"{available_gb:.1f} GB available", advice)


def _cache() -> Finding:
    folder = cache_dir()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder):
            pass
    except OSError as error:
        advice = "Name another folder with AOS_CACHE_DIR"
        return Finding("cache", "missing", f"{folder}: {error.strerror}", advice)
    return Finding("cache", "ok", str(folder))


def _sandbox() -> Finding:
    """The confinement of documents' code, tried with a program that looks for a file of this user."""
    support = sandbox_support()
    if not support.is_whole:
        advice = "Documents run only with trust: documents in the deploy file, or --trust-documents"
        return Finding("sandbox", "absent", "; ".join(support.missing), advice)
    if reason := what_a_confined_program_can():
        return Finding("sandbox", "missing", reason, "Please report this with the kernel's version")
    return Finding("sandbox", "ok", f"Landlock {support.landlock} and seccomp")
