"""A real service, small: `python -m small_service SETTINGS.json`, which behaves as its settings say."""

import asyncio
import signal
import sys
from pathlib import Path

from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.errors import DocumentError, SkillError, StorageError
from aos_runtime.processes.children import PIPE, Child, guarded
from aos_runtime.processes.lifecycle import Service, run_service
from aos_runtime.processes.settings import ServiceSettings


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """`mood` is `good`, `slow` (never ready), `faulty`, `broken`, `full` (its disk), `deaf` (to SIGTERM),
    `stuck` (ends at SIGUSR1) or `parental`."""

    mood: str = "good"


async def serve(service: Service[Settings]) -> None:
    match service.settings.mood:
        case "slow":
            print("still thinking", file=sys.stderr, flush=True)
            await asyncio.Event().wait()
        case "faulty":
            finding = Diagnostic(Severity.ERROR, "AOS102", "unknown key tabel", Span("room.yaml", 3, 1))
            raise DocumentError("the world is wrong", code="AOS102", hint="Mend it", diagnostics=(finding,))
        case "broken":
            raise RuntimeError("a defect")
        case "full":
            _leave_no_space_for_faults(service.settings)
            raise StorageError("the journal: database or disk is full", code="AOS701")
        case "parental":
            child = await Child.start(guarded(["sh", "-c", "sleep 1000 & echo; wait"]), stdout=PIPE)
            await child.stdout.readline()
    told = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGUSR1, told.set)
    try:
        if service.settings.mood == "deaf":
            asyncio.get_running_loop().remove_signal_handler(signal.SIGTERM)
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
        await service.ready()
        if service.settings.mood == "stuck":
            await told.wait()
            raise SkillError("the arm is stuck", code="AOS504")
        await asyncio.Event().wait()
    finally:
        _note_stop(service.settings)


def _leave_no_space_for_faults(settings: Settings) -> None:
    faults = Path(settings.run_dir, "faults")
    faults.rmdir()
    faults.touch()


def _note_stop(settings: Settings) -> None:
    with Path(settings.run_dir, "stopped").open("a") as stopped:
        stopped.write(f"{settings.service}\n")


if __name__ == "__main__":
    run_service(Settings, serve)
