"""An adapter that is a class of a user's own, and what such a class may get wrong."""

from pathlib import Path

import pytest
from adapter_process import AdapterProcess
from starting import until_present

from aos_protocol.errors import SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import ActivationId, SkillCall
from aos_runtime.adapters import Binding
from aos_runtime.bus.bus import Bus

ARM = """
class Arm:
    version = "1"

    def __init__(self, host):
        self.host = host

    async def start(self):
        await self.host.serve("/wave", "/drop")

    def call(self, call):
        if call.target == "/drop":
            raise RuntimeError("it slipped")
        return {"success": True}

    async def close(self):
        pass
"""


async def test_a_call_that_is_no_coroutine_fails_and_is_told_how_to_write_it(
    bus: Bus, keys: Keys, endpoint: str, tmp_path: Path
):
    (tmp_path / "hasty_arm.py").write_text(ARM)
    arm = AdapterProcess(bus, keys, endpoint, tmp_path)
    bound = {path: Binding() for path in ("/wave", "/drop")}
    try:
        async with until_present(bus, keys.live("arm")):
            await arm.launched("arm", adapter="hasty_arm:Arm", folder=str(tmp_path), bind=bound)
        with pytest.raises(SkillError, match="/wave answered at once") as told:
            await arm.ask(SkillCall(ActivationId("m", 1), "/wave", {}, 20.0))
        assert (told.value.code, "`async def call(self, call)`" in told.value.hint) == ("AOS510", True)
        with pytest.raises(SkillError, match="/drop failed: RuntimeError: it slipped"):
            await arm.ask(SkillCall(ActivationId("m", 2), "/drop", {}, 20.0))
    finally:
        await arm.stop()
