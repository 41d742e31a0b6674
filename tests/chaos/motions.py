"""Many calls of an adapter that is killed now and then, each asked for several times: no id may move twice.

    python -m tests.chaos.motions [--times N] [--kills N]

Two clients ask for each id at the same moment, one of them again after the next id, and after each kill.
"""

import argparse
import asyncio
import contextlib
import os
import random
import socket
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import msgspec

from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import ActivationId, SkillCall, SkillResult
from aos_runtime.adapters import AdapterSettings, Binding
from aos_runtime.bus import Bus
from aos_runtime.children import Child
from aos_runtime.lifecycle import ServiceSettings

KEYS = Keys("robot")
ROBOT = "def move(call):\n    print(call.id, file=open('motions', 'a'), flush=True)\n    return {}\n"
_HANG_S = 120.0


class Arm:
    """The adapter's process."""

    def __init__(self, folder: Path, endpoint: str) -> None:
        self._folder = folder
        settings = AdapterSettings(
            robot="robot",
            service="arm",
            endpoint=endpoint,
            run_dir=str(folder),
            adapter="aos_skills.python_functions:PythonAdapter",
            folder=str(folder),
            bind={"/move": Binding(target="robot.py:move")},
        )
        (folder / "robot.py").write_text(ROBOT)
        (folder / "arm.json").write_bytes(msgspec.json.encode(settings))

    async def start(self, bus: Bus) -> None:
        async with asyncio.timeout(_HANG_S), bus.presence(KEYS.all_serve) as present:
            argv = [sys.executable, "-m", "aos_runtime.adapters", "arm.json"]
            with (self._folder / "arm.log").open("ab") as log:
                self.process = await Child.start(argv, cwd=str(self._folder), stderr=log)
            async for _, is_there in present:
                if is_there:
                    return

    async def kill(self, bus: Bus) -> None:
        """Kills it, and returns when it has left the bus."""
        async with asyncio.timeout(_HANG_S), bus.presence(KEYS.all_serve) as present:
            self.process.kill()
            await self.process.wait()
            async for _, is_there in present:
                if not is_there:
                    return


async def ask(bus: Bus, step: int) -> str:
    """The code of the answer to a call, or nothing where it has succeeded."""
    call = SkillCall(ActivationId("m", step), "/move", {}, 20.0)
    try:
        await bus.ask(KEYS.call("/move"), call, SkillResult, timeout_s=_HANG_S)
    except AosError as error:
        return error.code
    return ""


async def measure(times: int, kills: int, endpoint: str, folder: Path) -> int:
    """The number of ids that have moved more than once; prints the table."""
    chance, codes = random.Random(1), Counter[str]()
    killed_at = set(chance.sample(range(1, times + 1), kills))
    arm = Arm(folder, endpoint)
    begun_s = time.monotonic()
    async with await Bus.open(endpoint, sender="one") as one, await Bus.open(endpoint, sender="two") as two:
        await arm.start(one)
        try:
            for step in range(1, times + 1):
                asking = [asyncio.create_task(ask(bus, step)) for bus in (one, two)]
                if step in killed_at:
                    await asyncio.wait(asking, timeout=chance.uniform(0.0, 0.004))
                    await arm.kill(one)
                    await arm.start(one)
                codes.update(await asyncio.gather(*asking))
                codes.update(
                    [await ask(two, max(step - 1, 1)), *([await ask(one, step)] if step in killed_at else [])]
                )
        finally:
            arm.process.kill()
            await arm.process.wait()
    moved = Counter((folder / "motions").read_text().split())
    twice = sum(count > 1 for count in moved.values())
    told = ", ".join(f"{code or 'succeeded'} {count}" for code, count in sorted(codes.items()))
    took_s = time.monotonic() - begun_s
    print(
        f"{times} ids, {kills} kills, {took_s:.0f} s: {len(moved)} ids moved, {twice} of them more than once"
    )
    print(f"answers: {told}; load {os.getloadavg()[0]:.1f}")
    return twice


def main() -> int:
    """Exit code 0 where no id has moved twice."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--times", type=int, default=10_000)
    parser.add_argument("--kills", type=int, default=50)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="aos-motions-") as name, socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        endpoint = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
        probe.close()
        settings = Path(name, "router.json")
        router = ServiceSettings(robot="robot", service="router", endpoint=endpoint, run_dir=name)
        settings.write_bytes(msgspec.json.encode(router))
        with subprocess.Popen([sys.executable, "-m", "aos_runtime.router", settings]) as routing:
            try:
                return int(asyncio.run(measure(options.times, options.kills, endpoint, Path(name))) > 0)
            finally:
                with contextlib.suppress(ProcessLookupError):
                    routing.terminate()


if __name__ == "__main__":
    sys.exit(main())
