import sys
from pathlib import Path

import pytest
from hostile.cases import MODELS
from hostile.counters import counting
from models import built_text, engine_of_text
from processes import finished
from texts import write_texts

from aos_protocol.errors import CodeFaultError, ModelError
from aos_runtime.processes.sandbox_trial import what_a_confined_program_can
from aos_runtime.sandbox.support import sandbox_support

needs_sandbox = pytest.mark.skipif(not sandbox_support().is_whole, reason="needs a kernel with a sandbox")


def lamp(code: str) -> dict[str, str]:
    """The documents of a lamp whose skill runs the code; it begins in line 5 of press.sd."""
    return counting("lamp", "press", code=code, steps="3")


REACHING = {
    "read": "reads a file",
    "list": "lists a folder",
    "execute": "executes a program",
    "connect": "opens a TCP socket",
    "kill": "kills its guard",
}
"""The skills of a lamp and their deeds."""


@pytest.fixture(scope="module")
def reaching() -> dict[str, str]:
    """The documents of the lamp: all skills are of one model. Its secret is this file, so that it is kept."""
    files: dict[str, str] = {}
    for skill, what in REACHING.items():
        code = MODELS[what].replace("SECRET", __file__).replace("FOLDER", str(Path(__file__).parent))
        files |= counting("lamp", skill, code=code, steps="3")
    return files


@needs_sandbox
@pytest.mark.parametrize("skill", REACHING)
async def test_a_model_that_reaches_out_ends_and_its_line_is_told(skill, reaching: dict[str, str]):
    async with engine_of_text(reaching) as engine:
        actions = [action.name for action in engine.description.actions]
        await engine.reset_world(1)
        with pytest.raises(CodeFaultError, match="reaches for what models may not") as caught:
            await engine.step_world(actions.index(skill))
    place = caught.value.diagnostics[0].span
    assert (place.file, place.line) == (f"{skill}.sd", 5)


@needs_sandbox
async def test_a_secret_does_not_come_into_a_program(tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("canary")
    with pytest.raises(ModelError) as caught:
        await built_text(lamp(f'asm(".incbin \\"{secret}\\"");'))
    place = caught.value.diagnostics[0].span
    assert (place.file, place.line) == ("press.sd", 5)


@needs_sandbox
def test_the_trial_of_the_sandbox_finds_nothing_that_a_confined_program_can_do():
    assert what_a_confined_program_can() == ""


def test_without_landlock_documents_run_only_where_they_are_trusted(tmp_path):
    write_texts(lamp(""), tmp_path)
    script = Path(__file__).parents[1] / "without_landlock.py"
    aos = str(Path(sys.executable).with_name("aos"))
    command = [sys.executable, str(script), aos, "lint", str(tmp_path)]
    refused = finished(*command)
    assert refused.returncode == 3
    assert "AOS805" in refused.stderr
    assert "no Landlock" in refused.stderr
    command.append("--trust-documents")
    trusted = finished(*command)
    assert trusted.returncode == 0, trusted.stderr
    assert "no Landlock" in trusted.stderr
