"""The host of adapters as a process, and calls of its skills as the middleware makes them."""

import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from processes import HANG_S

from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import Cancel, Cancelled, SkillCall, SkillResult
from aos_runtime.adapters import AdapterSettings
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child


async def started_adapter(keys: Keys, endpoint: str, run_dir: Path, service: str, **settings: Any) -> Child:
    values = AdapterSettings(
        robot=keys.robot, service=service, endpoint=endpoint, run_dir=str(run_dir), **settings
    )
    path = run_dir / f"{service}.json"
    path.write_bytes(msgspec.json.encode(values))
    with (run_dir / f"{service}.log").open("ab") as log:
        argv = [sys.executable, "-m", "aos_runtime.adapters", str(path)]
        return await Child.start(argv, stderr=log)


class AdapterProcess:
    """A process with one adapter, and how the middleware speaks to it."""

    call: Callable[..., Awaitable[SkillResult]]

    def __init__(self, bus: Bus, keys: Keys, endpoint: str, folder: Path):
        self.bus = bus
        self.keys = keys
        self.endpoint = endpoint
        self.folder = folder
        self.child: Child | None = None

    async def launched(self, service: str, **settings: Any) -> Child:
        """The process, which may not be ready yet."""
        self.child = await started_adapter(self.keys, self.endpoint, self.folder, service, **settings)
        return self.child

    async def ask(self, call: SkillCall) -> SkillResult:
        return await self.bus.ask(self.keys.call(call.path), call, SkillResult, timeout_s=HANG_S)

    async def refusal(self, *call: Any, **how: Any) -> AosError:
        with pytest.raises(AosError) as error:
            await self.call(*call, **how)
        return error.value

    async def cancel(self, path: str) -> Cancelled:
        return await self.bus.ask(self.keys.cancel(path), Cancel("enough"), Cancelled, timeout_s=HANG_S)

    async def stop(self):
        if self.child is not None:
            await self.child.stop(10.0)
