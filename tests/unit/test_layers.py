"""import-linter holds the sources to the layers and doors of docs/architecture.md, and would notice."""

import re
import sys
from pathlib import Path

from places import ROOT
from processes import finished

LINT = Path(sys.executable).parent / "lint-imports"


def broken(configuration: Path) -> list[str]:
    command = [LINT, "--config", configuration, "--no-cache"]
    done = finished(*command, cwd=ROOT)
    assert "Contracts: " in done.stdout, done.stdout + done.stderr
    return sorted(re.findall(r"^(.+) BROKEN$", done.stdout, re.MULTILINE))


def test_each_foreign_library_is_imported_through_its_door_alone():
    assert broken(ROOT / "pyproject.toml") == []


def test_an_import_past_a_door_would_be_noticed(tmp_path):
    text = (ROOT / "pyproject.toml").read_text()
    doors = re.findall(r'^name = "(The door to .+)"$', text, re.MULTILINE)
    assert len(doors) >= 7
    walled_up = tmp_path / "pyproject.toml"
    walled_up.write_text(
        re.sub(r"^allowed_importers = .*$", "allowed_importers = []", text, flags=re.MULTILINE)
    )
    assert broken(walled_up) == sorted(doors)
