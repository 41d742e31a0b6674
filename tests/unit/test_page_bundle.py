import asyncio
import gzip
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from page_sources import installed_sources
from places import ROOT
from processes import COMMAND_S
from starlette.requests import Request

from aos_gateway.api import page
from aos_gateway.api.page import page_routes

MADE = "services/gateway/aos_gateway/page"
SOURCES = "services/gateway/page"
MOST_SCRIPT_BYTES = 120_000


def files_in(folder: Path) -> dict[str, bytes]:
    """The unpacked contents of the page's files by the names that browsers ask for."""
    return {path.stem: gzip.decompress(path.read_bytes()) for path in folder.glob("*.gz")}


def test_scripts_are_small_when_compressed():
    scripts = list((ROOT / MADE).glob("*.js.gz"))
    assert scripts
    assert sum(script.stat().st_size for script in scripts) <= MOST_SCRIPT_BYTES


def test_licences_of_what_is_bundled_come_along():
    text = files_in(ROOT / MADE)["licences.txt"].decode()
    for library in ("preact", "htm", "@preact/signals"):
        assert f"\n{library} " in f"\n{text}"


def test_the_page_asks_no_other_server():
    files = files_in(ROOT / MADE)
    for name in ("index.html", "page.js", "page.css"):
        text = files[name].decode()
        named = {word for word in text.split('"') if word.startswith(("http://", "https://", "//"))}
        assert not {address for address in named if not address.startswith("http://www.w3.org/")}, name


def test_what_its_sources_make_is_what_comes_with_aos(tmp_path):
    libraries = installed_sources() / "node_modules"
    sources = tmp_path / "page"
    shutil.copytree(ROOT / SOURCES, sources, ignore=shutil.ignore_patterns("node_modules"))
    (sources / "node_modules").symlink_to(libraries)
    made = tmp_path / "made"
    subprocess.run(["node", "build.mjs", made], cwd=sources, check=True, timeout=COMMAND_S)
    kept, anew = files_in(ROOT / MADE), files_in(made)
    assert kept.keys() == anew.keys()
    other = [name for name in kept if kept[name] != anew[name]]
    assert other == [], "run `make page`, and commit what it makes"


@pytest.mark.parametrize("name", ["page.js", "page.css", "licences.txt", "index.html"])
def test_a_browser_gets_a_file_as_it_understands_it(name):
    files = files_in(ROOT / MADE)
    (route,) = (each for each in page_routes() if each.path == ("/" if name == "index.html" else f"/{name}"))
    packed, plain = (
        asyncio.run(route.endpoint(Request({"type": "http", "headers": [(b"accept-encoding", encoding)]})))
        for encoding in (b"gzip, br", b"identity")
    )
    assert packed.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in plain.headers
    assert gzip.decompress(packed.body) == plain.body == files[name]
    assert packed.headers["content-type"] == plain.headers["content-type"]


def test_a_page_that_is_made_anew_is_what_a_browser_gets_next(tmp_path, monkeypatch):
    def body() -> bytes:
        return bytes(asyncio.run(route.endpoint(Request({"type": "http", "headers": []}))).body)

    made = tmp_path / "page.js.gz"
    made.write_bytes(gzip.compress(b"before"))
    monkeypatch.setattr(page, "_FOLDER", tmp_path)
    (route,) = page.page_routes()
    assert body() == b"before"
    for content, expected in ((gzip.compress(b"after")[:-9], b"before"), (gzip.compress(b"after"), b"after")):
        made.write_bytes(content)
        made_at_ns = made.stat().st_mtime_ns + 1_000_000_000
        os.utime(made, ns=(made_at_ns, made_at_ns))
        assert body() == expected
