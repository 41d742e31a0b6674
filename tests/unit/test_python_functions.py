from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from aos_protocol.errors import DeployError, SkillError
from aos_protocol.messages import ActivationId
from aos_runtime.adapters import Binding, Call, Host
from aos_skills.python_functions import PythonAdapter

ROBOT = """
def leave(call):
    raise SystemExit(4)

async def leave_soon(call):
    raise SystemExit(4)

def look_in_vain(call):
    return {"cup": next(cup for cup in [] if cup)}

def wave(call):
    return {"waved": True}

class Far:
    def __init__(self, port, speed): pass
    def reach(self, call): return {}

class Lost:
    def __init__(self):
        raise OSError("no arm at /dev/ttyUSB0")
    def reach(self, call): return {}

class Near:
    def __init__(self, port="/dev/ttyUSB0"):
        self.port = port
    def reach(self, call): return {"port": self.port}

class Hosted:
    def __init__(self, host=None):
        self.host = host
    def reach(self, call): return {"name": self.host.name}
"""


def adapter_of(folder: Path, **bound: str) -> PythonAdapter:
    (folder / "robot.py").write_text(ROBOT)

    async def serve(*paths: str):
        return

    bindings = {f"/{path}": Binding(target=f"robot.py:{name}") for path, name in bound.items()}
    host = SimpleNamespace(bound=bindings, options={}, folder=folder, name="arm", serve=serve)
    return PythonAdapter(cast("Host", host))


async def end(adapter: PythonAdapter):
    """Closes the adapter, and its event loop, which else ends with the process."""
    await adapter.close()
    adapter._thread.join()
    adapter._loop.close()


async def answer(adapter: PythonAdapter, path: str) -> Any:
    return await adapter.call(Call(ActivationId("m", 1), path, path, {}, 5.0))


async def test_a_function_that_would_end_the_process_fails_its_call_and_the_next_one_runs(tmp_path):
    names = ("leave", "leave_soon", "look_in_vain", "wave")
    adapter = adapter_of(tmp_path, **{name: name for name in names})
    await adapter.start()
    for path, error in (
        ("/leave", "SystemExit(4)"),
        ("/leave_soon", "SystemExit(4)"),
        ("/look_in_vain", "StopIt"),
    ):
        with pytest.raises(SkillError) as failed:
            await answer(adapter, path)
        assert (failed.value.code, failed.value.message.startswith(f"{path} failed: {error}")) == (
            "AOS510",
            True,
        )
    assert await answer(adapter, "/wave") == {"waved": True}
    await end(adapter)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Far.reach", "'port' and 'speed'. It is made without arguments, or with the host alone"),
        ("Lost.reach", "cannot be made: OSError: no arm at /dev/ttyUSB0. It was raised at robot.py:20"),
    ],
)
async def test_a_class_that_cannot_be_made_is_the_users_mistake_at_its_line(tmp_path, name, text):
    adapter = adapter_of(tmp_path, reach=name)
    with pytest.raises(DeployError) as refused:
        await adapter.start()
    assert text in str(refused.value)
    await end(adapter)


async def test_a_class_is_made_with_the_host_only_where_it_asks_for_one(tmp_path):
    adapter = adapter_of(tmp_path, near="Near.reach", hosted="Hosted.reach")
    await adapter.start()
    assert await answer(adapter, "/near") == {"port": "/dev/ttyUSB0"}
    assert await answer(adapter, "/hosted") == {"name": "arm"}
    await end(adapter)
