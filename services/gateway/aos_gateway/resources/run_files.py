"""The files of a run on this machine that can be read: logs of its processes, pictures of its world."""

import asyncio
import re
from pathlib import Path
from typing import Annotated

import msgspec

from aos_deploy.runs.record import ProcessEnd
from aos_gateway.operations import Content
from aos_gateway.runs.run import KeptRun
from aos_gateway.shared import Gateway
from aos_protocol.errors import GatewayError, StorageError
from aos_protocol.keys import NAME

_LOG_BYTES = 200_000
_PICTURE = re.compile(r"(?:step-?)?0*(\d+)\.(png|jpg)")


class Pictures(msgspec.Struct, frozen=True):
    """The steps of which there is a picture."""

    steps: tuple[int, ...]


class ServiceView(msgspec.Struct, frozen=True):
    """A process of a run: whether it is on the bus now, and the size of its log."""

    service: str
    pid: int
    log_bytes: int


class Services(msgspec.Struct, frozen=True):
    """The processes of a run, and those that have ended by themselves."""

    services: tuple[ServiceView, ...]
    ends: tuple[ProcessEnd, ...]


class OfLog(msgspec.Struct, frozen=True):
    """The number of bytes from the end of a log."""

    tail: Annotated[int, msgspec.Meta(ge=1, le=2_000_000)] = _LOG_BYTES


async def services(gateway: Gateway, run: str) -> Services:
    """The processes of a run."""
    found = _kept(gateway, run)
    summary = found.directory.read_summary()
    views = tuple(
        ServiceView(name, pid, _size_of(found, name))
        for name, pid in found.directory.read_record().pids.items()
    )
    return Services(views, summary.process_ends if summary is not None else ())


async def log(gateway: Gateway, run: str, service: str, query: OfLog) -> Content:
    """The end of a service's log, as text."""
    found = _kept(gateway, run)
    # A record that somebody has sent may name anything, and a log is named by its service.
    if not NAME.fullmatch(service) or service not in found.directory.read_record().pids:
        raise GatewayError(f"the run {run} has no service {service}")
    return Content(await asyncio.to_thread(_tail, found, service, query.tail), "text/plain; charset=utf-8")


async def pictures(gateway: Gateway, mission: str) -> Pictures:
    """The steps of which the world has left a picture."""
    found = await gateway.shelf.run_of_mission(mission)
    return Pictures(tuple(_pictures(found)) if isinstance(found, KeptRun) else ())


async def picture(gateway: Gateway, mission: str, step: str) -> Content:
    """The picture of the world at a step."""
    found = await gateway.shelf.run_of_mission(mission)
    path = _pictures(found).get(number_of_step(step)) if isinstance(found, KeptRun) else None
    if path is None:
        raise GatewayError(f"there is no picture of step {step}")
    media = "image/png" if path.suffix == ".png" else "image/jpeg"
    return Content(await asyncio.to_thread(_bytes_of, path), media)


def number_of_step(step: str) -> int:
    """The number in a path; GatewayError AOS901 if it is none."""
    if not (step.isascii() and step.isdigit() and len(step) < 16):
        raise GatewayError(f"{step} is no number of a step", code="AOS901")
    return int(step)


def _kept(gateway: Gateway, name: str) -> KeptRun:
    found = gateway.shelf.run(name)
    if not isinstance(found, KeptRun):
        raise GatewayError(f"the run {name} has no directory on this machine")
    return found


def _size_of(found: KeptRun, service: str) -> int:
    path = found.directory.log(service)
    return path.stat().st_size if path.exists() else 0


def _tail(found: KeptRun, service: str, size_bytes: int) -> bytes:
    path = found.directory.log(service)
    if not path.exists():
        return b""
    try:
        with path.open("rb") as file:
            file.seek(max(0, path.stat().st_size - size_bytes))
            return file.read(size_bytes)
    except OSError as error:
        raise _unreadable(path, error) from error


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise _unreadable(path, error) from error


def _unreadable(path: Path, error: OSError) -> StorageError:
    return StorageError(f"{path} cannot be read: {error.strerror}", code="AOS702")


def _pictures(found: KeptRun) -> dict[int, Path]:
    folder = found.directory.path / "pictures"
    if not folder.is_dir():
        return {}
    named = ((_PICTURE.fullmatch(path.name), path) for path in sorted(folder.iterdir()))
    return {int(match[1]): path for match, path in named if match}
