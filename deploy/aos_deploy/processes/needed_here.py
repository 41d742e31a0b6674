"""The check that what a deploy file starts is on this machine, before anything is started."""

import resource
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from aos_deploy.deployment.adapter_kinds import check_installed
from aos_deploy.deployment.adapters import SPANS
from aos_deploy.deployment.reading import Deployment
from aos_deploy.processes.program import programs_of_deployment
from aos_deploy.processes.remote import check_ssh
from aos_deploy.processes.start import LOG_BYTES, check_command
from aos_deploy.spans.otlp import check_otel_installed
from aos_protocol.errors import DeployError
from aos_runtime.sandbox.support import require_sandbox, trust_documents

OPEN_FILES = 64
"""A process of a mission may have to open so many files."""


def check_sandbox(deployment: Deployment) -> None:
    """Raises DeployError AOS805 where the kernel cannot confine documents and nobody says to trust them.

    Where the deploy file does, all that this process starts is told so.
    """
    if deployment.file.trust == "documents":
        trust_documents()
    require_sandbox()


def check_needed_here(deployment: Deployment) -> None:
    """Raises DeployError AOS805 for a package or ssh that is missing, a limit of the shell that is too low or
    a path that no record can name, AOS802 for a program that is not there."""
    _check_limit(resource.RLIMIT_NOFILE, "-n", OPEN_FILES, 1, "files that a process opens")
    _check_limit(resource.RLIMIT_FSIZE, "-f", LOG_BYTES, 1024, "kB in a file")
    for path in (deployment.path, deployment.runs):
        _check_name(path)
    for _, _, check in needs_of(deployment):
        check()


def _check_limit(kind: int, option: str, least: int, unit: int, what: str) -> None:
    limit, _ = resource.getrlimit(kind)
    if limit not in range(least):
        return
    message = f"`ulimit {option}` is {limit // unit}, and a mission needs {least // unit} {what}"
    raise DeployError(message, code="AOS805", hint="Raise this limit of the shell, the container or the unit")


def _check_name(path: Path) -> None:
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        text, hint = (
            f"{str(path)!r} is no UTF-8, and no record can name it",
            "Move it, or give it another name",
        )
        if (encoding := sys.getfilesystemencoding()) != "utf-8":
            text = f"the locale has Python read names of files as {encoding}, and {str(path)!r} is none"
            hint = "Set LC_ALL=C.UTF-8, and no PYTHONUTF8=0"
        raise DeployError(text, code="AOS805", hint=hint) from error


def needs_of(deployment: Deployment) -> Iterator[tuple[str, str, Callable[[], None]]]:
    """Each adapter and program by its name, what it is, and what raises if it cannot be started here."""
    for adapter in deployment.adapters:
        if not adapter.is_command:
            kind = f"adapter of the kind {adapter.kind_name}"
            yield adapter.name, kind, partial(check_installed, adapter.name, adapter.kind)
    if deployment.file.spans.otlp:
        yield SPANS, f"spans to {deployment.file.spans.otlp}", check_otel_installed
    for program in programs_of_deployment(deployment):
        what = f"{'program' if program.is_own else 'adapter'} {' '.join(program.command)}"
        if program.host:
            where = f"{what} on {program.host}, which is not looked at"
            yield program.name, where, partial(check_ssh, program.name, program.host)
        elif program.command:
            folder = deployment.path.parent
            yield program.name, what, partial(check_command, program.name, program.command, folder)
