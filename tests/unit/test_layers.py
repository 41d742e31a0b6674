"""import-linter holds the sources to the layers and doors of docs/architecture.md, and would notice."""

import re
import subprocess
import sys
from pathlib import Path

from processes import COMMAND_S

LINT = Path(sys.executable).parent / "lint-imports"


def broken(root: Path, configuration: Path) -> list[str]:
    command = [LINT, "--config", configuration, "--no-cache"]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=COMMAND_S, check=False)
    assert "Contracts: " in done.stdout, done.stdout + done.stderr
    return sorted(re.findall(r"^(.+) BROKEN$", done.stdout, re.MULTILINE))


def test_each_foreign_library_is_imported_through_its_door_alone(root: Path):
    assert broken(root, root / "pyproject.toml") == []


def test_an_import_past_a_door_would_be_noticed(root: Path, tmp_path):
    text = (root / "pyproject.toml").read_text()
    doors = re.findall(r'^name = "(The door to .+)"$', text, re.MULTILINE)
    assert len(doors) >= 7
    walled_up = tmp_path / "pyproject.toml"
    walled_up.write_text(
        re.sub(r"^allowed_importers = .*$", "allowed_importers = []", text, flags=re.MULTILINE)
    )
    assert broken(root, walled_up) == sorted(doors)
