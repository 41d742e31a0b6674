"""The output of commands where nobody looks at a terminal: their results, and nothing beside them."""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from models import built_bundle
from processes import COMMAND_S

AOS = Path(sys.executable).parent / "aos"
COMMANDS = (
    ("simulate", "--runs", "2", "--simulations", "10"),
    ("plan", "--simulations", "10"),
    ("plan", "--exact", "--horizon", "3"),
    ("solve", "--time", "0.1"),
)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_piped_command_says_nothing_beside_its_result(
    command: tuple[str, ...], bundles: Path, cache_dir: Path
) -> None:
    bundle = bundles / "bench" / "tiger"
    asyncio.run(built_bundle(bundle, cache_dir))
    done = subprocess.run(
        [AOS, command[0], str(bundle), *command[1:], "--json"],
        capture_output=True,
        text=True,
        timeout=COMMAND_S,
        env={**os.environ, "AOS_CACHE_DIR": str(cache_dir)},
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)
    assert done.stderr == ""


def test_an_output_that_cannot_be_written_is_told_in_one_line() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [AOS, "schema", "deploy"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=COMMAND_S
        )
    assert done.returncode == 3
    assert done.stderr == "aos: the output cannot be written: No space left on device\n"
