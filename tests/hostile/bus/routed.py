"""A router with access control as a process, and bare Zenoh sessions on it, without `Bus`."""

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import zenoh
from zenoh.handlers import Callback

from aos_deploy.processes.passes import Passes
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.access import ROUND_TRIP, Party
from aos_runtime.bus.config import client_config
from aos_runtime.bus.credentials import Credential
from aos_runtime.processes.parent import PARENT_VARIABLE
from aos_runtime.router.routing import RouterSettings

ROBOT = "test"
_PATIENCE_S = 30.0


class Routed:
    """A router that knows its parties. `sessions` has one for each, by name."""

    def __init__(self, endpoint: str, passes: Passes, log: Path, pid: int):
        self.endpoint = endpoint
        self.passes = passes
        self.log = log
        self.pid = pid
        self.sessions: dict[str, zenoh.Session] = {}

    def session(self, name: str) -> zenoh.Session:
        if name not in self.sessions:
            self.sessions[name] = opened(self.endpoint, self.passes.credential(name))
        return self.sessions[name]


@contextmanager
def routed(folder: Path, parties: tuple[Party, ...]) -> Iterator[Routed]:
    run = RunDirectory.create(folder, ROBOT, 0)
    endpoint = run.make_endpoint()
    passes = Passes(run, parties)
    passes.write_dictionary()
    settings = RouterSettings(
        robot=ROBOT,
        service="router",
        endpoint=endpoint,
        run_dir=str(run.path),
        dictionary=str(passes.dictionary),
        parties=passes.parties,
    )
    path = run.write_settings("router", msgspec.to_builtins(settings))
    with (
        run.open_log("router") as log,
        subprocess.Popen(
            [sys.executable, "-m", "aos_runtime.router", str(path)],
            env={**os.environ, PARENT_VARIABLE: str(os.getpid())},
            stdout=log,
            stderr=log,
        ) as router,
    ):
        made = Routed(endpoint, passes, run.log("router"), router.pid)
        try:
            yield made
        finally:
            for session in made.sessions.values():
                session.close()
            router.terminate()
    run.close()


def opened(endpoint: str, credential: Credential | None) -> zenoh.Session:
    """A session, once the router is there; ZError if it lets nobody in."""
    config = client_config(endpoint, credential=credential)
    config.insert_json5("connect/timeout_ms", str(int(_PATIENCE_S * 1000)))
    return zenoh.open(config)


def round_trip(*sessions: zenoh.Session):
    for session in sessions:
        done = threading.Event()
        session.liveliness().get(ROUND_TRIP, Callback(_ignore, done.set, indirect=False), timeout=_PATIENCE_S)
        if not done.wait(_PATIENCE_S):
            raise TimeoutError("the router does not answer")


def _ignore(_: Any):
    """Takes replies whose end alone matters."""
