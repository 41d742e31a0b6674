"""The page that comes with AOS is what its sources make, and small."""

from __future__ import annotations

import filecmp
import gzip
import shutil
import subprocess
from pathlib import Path

from page_sources import installed_sources
from processes import COMMAND_S

MADE = "services/gateway/aos_gateway/page"
SOURCES = "services/gateway/page"
MOST_SCRIPT_BYTES = 120_000


def test_scripts_are_small_when_compressed(root: Path) -> None:
    scripts = list((root / MADE).glob("*.js"))
    assert scripts
    assert sum(len(gzip.compress(script.read_bytes())) for script in scripts) <= MOST_SCRIPT_BYTES


def test_licences_of_what_is_bundled_come_along(root: Path) -> None:
    text = (root / MADE / "licences.txt").read_text()
    for library in ("preact", "htm", "@preact/signals"):
        assert f"\n{library} " in f"\n{text}"


def test_the_page_asks_no_other_server(root: Path) -> None:
    for name in ("index.html", "page.js", "page.css"):
        text = (root / MADE / name).read_text()
        named = {word for word in text.split('"') if word.startswith(("http://", "https://", "//"))}
        assert not {address for address in named if not address.startswith("http://www.w3.org/")}, name


def test_what_its_sources_make_is_what_comes_with_aos(root: Path, tmp_path: Path, cache_dir: Path) -> None:
    libraries = installed_sources(root, cache_dir) / "node_modules"
    sources = tmp_path / "page"
    shutil.copytree(root / SOURCES, sources, ignore=shutil.ignore_patterns("node_modules"))
    (sources / "node_modules").symlink_to(libraries)
    made = tmp_path / "made"
    subprocess.run(["node", "build.mjs", made], cwd=sources, check=True, timeout=COMMAND_S)
    names = {path.name for path in (root / MADE).iterdir()}
    assert {path.name for path in made.iterdir()} == names
    _, other, missing = filecmp.cmpfiles(root / MADE, made, sorted(names), shallow=False)
    assert (other, missing) == ([], []), "run `make page`, and commit what it makes"
