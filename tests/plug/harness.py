"""Router, middleware and adapter as processes for measurements; the caller is registry and solver."""

import asyncio
import socket
import sys
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import msgspec

from aos_language.load import load_files
from aos_middleware.settings import Settings
from aos_protocol.documents import Project
from aos_protocol.errors import DocumentError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Activate,
    ActivationId,
    MappingQuery,
    MappingState,
    Outcome,
    ProjectQuery,
    ProjectRevision,
)
from aos_runtime.adapters import AdapterSettings, Binding
from aos_runtime.bus.bus import Bus
from aos_runtime.parties.reported_state import state_when
from aos_runtime.processes.children import Child
from aos_runtime.processes.lifecycle import ServiceSettings

PATIENCE_S = 60.0

ENVIRONMENT = (
    "project: numbers\nhorizon: 1\ndiscount: 1\nstate_variable: bool is_done\ncode:\nstate.is_done = false;\n"
)
MODEL = "project: numbers\ndynamic_model:\n__moduleResponse = done;\n__reward = -1;\n"
MAPPING = "project: numbers\nresponse: done\nresponse_rule: True\nmodule_activation: skill\npath: /{path}\n"


def project_of(skills: dict[str, str]) -> Project:
    """A project whose skills have these mappings, beyond response and path, by name."""
    files = {"numbers.ef": ENVIRONMENT.encode()}
    for name, text in skills.items():
        files[f"{name}.sd"] = MODEL.encode()
        files[f"{name}.am"] = (MAPPING.format(path=name) + text).encode()
    loaded = load_files(files, name="numbers")
    if loaded.project is None:
        raise DocumentError("the documents have errors", diagnostics=loaded.diagnostics)
    return loaded.project


class Harness:
    """The parts that a measurement works with; `folder` is the run directory."""

    def __init__(self, bus: Bus, keys: Keys, folder: Path, endpoint: str) -> None:
        self.bus = bus
        self.keys = keys
        self.folder = folder
        self.endpoint = endpoint
        self.middleware: Child | None = None
        self.children: list[Child] = []

    async def adapter(self, text: str, bind: dict[str, str], name: str = "python") -> Child:
        """A process with the functions of a file."""
        (self.folder / f"{name}_skills.py").write_text(text)
        settings = AdapterSettings(
            **self._base(name),
            adapter="aos_skills.python_functions:PythonAdapter",
            folder=str(self.folder),
            bind={path: Binding(target=f"{name}_skills.py:{target}") for path, target in bind.items()},
        )
        return await self.start("aos_runtime.adapters", settings)

    async def start(self, module: str, settings: ServiceSettings) -> Child:
        path = self.folder / f"{settings.service}.json"
        path.write_bytes(msgspec.json.encode(settings))
        with (self.folder / f"{settings.service}.log").open("ab") as log:
            child = await Child.start([sys.executable, "-m", module, str(path)], stdout=log, stderr=log)
        self.children.append(child)
        return child

    async def until_available(self, *, skills: int, timeout_s: float = PATIENCE_S) -> None:
        """Returns when so many skills can be run."""
        await state_when(
            self.bus,
            self.keys.mapping_state,
            MappingQuery(),
            MappingState,
            lambda state: len(state.skills) - len(state.unavailable) >= skills,
            timeout_s=timeout_s,
        )

    async def activate(self, skill: str, step: int, deadline_s: float = 10.0) -> Outcome:
        request = Activate(ActivationId("numbers", step), skill, {}, deadline_s)
        return await self.bus.ask(
            self.keys.activate(skill), request, Outcome, timeout_s=deadline_s + PATIENCE_S
        )

    def _base(self, service: str) -> dict[str, Any]:
        return {
            "robot": self.keys.robot,
            "service": service,
            "endpoint": self.endpoint,
            "run_dir": str(self.folder),
        }


@asynccontextmanager
async def harness(project: Project) -> AsyncIterator[Harness]:
    """Router and middleware, with the project; everything is ended with the block."""
    with tempfile.TemporaryDirectory(prefix="aos-numbers-") as name:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
        keys, folder = Keys("numbers"), Path(name)
        base = {"robot": "numbers", "endpoint": endpoint, "run_dir": name}
        router = Harness.__new__(Harness)
        router.folder, router.children = folder, []
        await router.start("aos_runtime.router", ServiceSettings(service="router", **base))
        async with await Bus.open(endpoint, sender="numbers", connect_timeout_s=PATIENCE_S) as bus:

            async def answer(_: ProjectQuery, __: str) -> ProjectRevision:
                return ProjectRevision(1, "digest", project)

            await bus.answer(keys.project, ProjectQuery, answer)
            made = Harness(bus, keys, folder, endpoint)
            try:
                settings = Settings(service="middleware", project="numbers", **base)
                made.middleware = await made.start("aos_middleware", settings)
                yield made
            finally:
                await asyncio.gather(*(child.stop(3.0) for child in made.children))
        await asyncio.gather(*(child.stop(3.0) for child in router.children))


async def drained(stream: asyncio.StreamReader) -> None:
    """Returns at the end of a stream that nobody reads."""
    while await stream.read(2**16):
        pass
