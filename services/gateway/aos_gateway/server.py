"""The gateway as a process: its socket, its note for `aos-up --page`, and uvicorn."""

import asyncio
import os
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import msgspec
import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send

from aos_deploy.page_address import GatewayNote
from aos_deploy.places import gateway_folder
from aos_deploy.runs.living import living_runs
from aos_gateway.api.access import access_of, kept_token
from aos_gateway.api.app import make_app
from aos_gateway.metrics.counting import Metrics
from aos_gateway.runs.drawings import Drawings
from aos_gateway.runs.feed import Watches
from aos_gateway.runs.run import RemoteRun
from aos_gateway.runs.shelf import RunShelf
from aos_gateway.runs.trace import Traces
from aos_gateway.shared import Gateway
from aos_protocol.errors import DeployError

_LOOKS = 4
_LOOK_S = 5.0


class Use:
    """An application that knows since when nobody has asked it anything. A page that is open does ask."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._open = 0
        self._last_s = time.monotonic()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self._open += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._open -= 1
            self._last_s = time.monotonic()

    async def until_unused(self, for_s: float) -> None:
        """Returns once nobody has looked, and no mission of this machine has run, for so many seconds."""
        while time.monotonic() - self._last_s < for_s:
            await asyncio.sleep(min(for_s / _LOOKS, _LOOK_S))
            living = await asyncio.to_thread(living_runs)
            if self._open or living:
                self._last_s = time.monotonic()


_LAST_STREAMS_S = 1
"""Streams are cut this long after the gateway was told to end."""
_BACKLOG = 128


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `aos serve`. `remote` are endpoints with their robots, `sent` are runs out of files.

    With `unused_s` it ends when nobody has looked for so long, and no mission has run.
    """

    host: str = "127.0.0.1"
    port: int = 7480
    names: tuple[str, ...] = ()
    is_private: bool = True
    runs: tuple[Path, ...] = (Path("runs"),)
    sent: tuple[Path, ...] = ()
    projects: tuple[Path, ...] = ()
    remote: tuple[tuple[str, str], ...] = ()
    has_metrics: bool = False
    unused_s: float | None = None


async def serve_gateway(settings: Settings, ready: Callable[[str, str], None]) -> None:
    """Serves until it is interrupted. `ready` is told the address and the token once requests are answered.

    DeployError AOS802 if the address is taken or is none of this machine.
    """
    folder = gateway_folder()
    token = kept_token(folder / "token")
    with listening(settings.host, settings.port) as listener:
        port = listener.getsockname()[1]
        shown = f"[{settings.host}]" if ":" in settings.host else settings.host
        shown = {"0.0.0.0": "127.0.0.1", "[::]": "[::1]"}.get(shown, shown)
        address = f"http://{shown}:{port}/"
        access = access_of(settings.host, settings.names, token, is_private=settings.is_private)
        async with asyncio.TaskGroup() as tasks:
            watches = Watches(tasks)
            shelf = RunShelf(settings.runs, [RemoteRun(*each) for each in settings.remote], settings.sent)
            gateway = Gateway(
                shelf=shelf,
                watches=watches,
                projects=tuple(path.resolve() for path in settings.projects),
                folder=folder,
                runs=settings.runs[0].resolve(),
                studying=asyncio.Semaphore(1),
                traces=Traces(),
                drawings=Drawings(),
                metrics=await asyncio.to_thread(Metrics, shelf) if settings.has_metrics else None,
            )
            use = Use(make_app(gateway, access))
            config = uvicorn.Config(
                use,
                log_config=None,
                access_log=False,
                lifespan="off",
                server_header=False,
                timeout_graceful_shutdown=_LAST_STREAMS_S,
            )
            with _noted(folder, GatewayNote(address, os.getpid(), settings.unused_s)):
                ready(address, token)
                server = uvicorn.Server(config)
                ending = tasks.create_task(_end_unused(server, use, settings.unused_s))
                await server.serve(sockets=[listener])
                ending.cancel()
            watches.close()


async def _end_unused(server: uvicorn.Server, use: Use, unused_s: float | None) -> None:
    if unused_s is not None:
        await use.until_unused(unused_s)
        server.should_exit = True


@contextmanager
def listening(host: str, port: int) -> Iterator[socket.socket]:
    """A listening socket of TCP, as which asyncio knows it and switches Nagle's algorithm off.

    Else each answer on a connection that is kept waits 40 ms for an acknowledgement.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((host, port))
        except OSError as error:
            message = f"cannot listen at {host}:{port}: {error.strerror}"
            hint = "Another gateway may run there; `--port 0` takes any free port"
            raise DeployError(message, code="AOS802", hint=hint) from error
        listener.listen(_BACKLOG)
        yield listener


@contextmanager
def _noted(folder: Path, note: GatewayNote) -> Iterator[None]:
    """Lets `aos-up --page` find this gateway while it serves."""
    path = folder / "gateway.json"
    path.write_bytes(msgspec.json.encode(note))
    try:
        yield
    finally:
        with suppress(OSError, msgspec.MsgspecError):
            if msgspec.json.decode(path.read_bytes(), type=GatewayNote).pid == note.pid:
                path.unlink()
