"""The check that what a deploy file starts is on this machine, before anything is started."""

from collections.abc import Callable, Iterator
from functools import partial

from aos_deploy.adapter_kinds import check_installed
from aos_deploy.adapters import SPANS
from aos_deploy.deploy_file import Deployment
from aos_deploy.process_start import check_command
from aos_deploy.program import programs_of_deployment
from aos_deploy.remote import check_ssh
from aos_deploy.spans.otlp import check_otel_installed
from aos_runtime.sandbox.support import require_sandbox, trust_documents


def check_sandbox(deployment: Deployment) -> None:
    """Raises DeployError AOS805 where the kernel cannot confine documents and nobody says to trust them.

    Where the deploy file does, all that this process starts is told so.
    """
    if deployment.file.trust == "documents":
        trust_documents()
    require_sandbox()


def check_needed_here(deployment: Deployment) -> None:
    """Raises DeployError AOS805 for a package or ssh that is missing, AOS802 for a program that is not
    there."""
    for _, _, check in needs_of(deployment):
        check()


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
