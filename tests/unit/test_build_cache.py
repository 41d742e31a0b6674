import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from processes import HANG_S

from aos_protocol.errors import StorageError
from aos_solver.building import build_cache
from aos_solver.building.build_cache import BuildCache
from aos_solver.building.compiler_run import internal_error

HOLDER = """
import asyncio, sys
from pathlib import Path
from aos_solver.building.build_cache import build_lock

async def hold():
    async with build_lock(Path(sys.argv[1]), 0.0, lambda: None):
        print("held", flush=True)
        sys.stdin.read()

asyncio.run(hold())
"""


@contextmanager
def another_process_makes(entry: Path) -> Iterator[subprocess.Popen[str]]:
    lock = entry.with_name(f"{entry.name}.lock")
    command = [sys.executable, "-c", HOLDER, str(lock)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        yield holder
        holder.kill()


def names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


async def make(staging: Path):
    (staging / "part").write_text("whole")


async def test_one_makes_an_entry_and_the_others_wait_for_it(tmp_path):
    makers: list[Path] = []
    others_wait = asyncio.Event()

    async def make_slowly(staging: Path):
        makers.append(staging)
        await others_wait.wait()

    waiting: list[None] = []

    def on_wait():
        waiting.append(None)
        if len(waiting) == 2:
            others_wait.set()

    fills = [
        BuildCache(tmp_path).fill("model-a", make_slowly, patience_s=HANG_S, on_wait=on_wait)
        for _ in range(3)
    ]
    assert await asyncio.gather(*fills) == [tmp_path / "model-a"] * 3
    assert len(makers) == 1
    assert names(tmp_path) == ["model-a"]


async def test_what_another_process_makes_is_waited_for(tmp_path):
    entry = tmp_path / "model-b"
    with another_process_makes(entry) as holder:

        def finish():
            entry.mkdir()
            holder.communicate()

        assert await BuildCache(tmp_path).fill(entry.name, make, patience_s=HANG_S, on_wait=finish) == entry
    assert names(entry) == []  # the other one's


async def test_what_a_killed_process_did_not_finish_is_made_here(tmp_path):
    with another_process_makes(tmp_path / "model-c") as holder:
        entry = await BuildCache(tmp_path).fill("model-c", make, patience_s=HANG_S, on_wait=holder.kill)
    assert (entry / "part").read_text() == "whole"
    assert names(tmp_path) == ["model-c"]


async def test_a_process_that_does_not_get_on_is_waited_for_until_a_deadline(tmp_path):
    with another_process_makes(tmp_path / "model-d"):
        entry = await BuildCache(tmp_path).fill("model-d", make, patience_s=0.3)
    assert (entry / "part").read_text() == "whole"


async def test_who_waits_for_a_failure_tries_by_itself(tmp_path):
    has_lock, somebody_waits = asyncio.Event(), asyncio.Event()

    async def fail(_: Path):
        has_lock.set()
        await somebody_waits.wait()
        raise RuntimeError("no")

    failing = asyncio.create_task(BuildCache(tmp_path).fill("model-e", fail))
    await has_lock.wait()
    entry = await BuildCache(tmp_path).fill("model-e", make, patience_s=HANG_S, on_wait=somebody_waits.set)
    with pytest.raises(RuntimeError):
        await failing
    assert (entry / "part").exists()


async def test_a_cache_that_cannot_be_written_is_told_with_the_way_to_another(tmp_path):
    (tmp_path / "file").write_text("no folder can be here")
    with pytest.raises(StorageError, match=r"cannot be written: .*AOS_CACHE_DIR"):
        await BuildCache(tmp_path / "file" / "cache").fill("model-1", make)


async def test_beyond_its_size_the_cache_loses_what_was_not_asked_for_the_longest(tmp_path, monkeypatch):
    monkeypatch.setattr(build_cache, "_MOST_USED", 0)  # The process that has made them has ended.

    async def make_large(staging: Path):
        (staging / "headers").mkdir()
        (staging / "headers" / "part").write_bytes(bytes(100_000))

    cache = BuildCache(tmp_path, size_bytes=250_000)
    # The clock was set back after the first two were asked for.
    for age_s, name in (
        (-10_000, "model-old"),
        (-30_000, "model-new"),
        (30_000, "model-oldest"),
        (20_000, "model-older"),
    ):
        entry = await cache.fill(name, make_large)
        os.utime(entry, (time.time() - age_s,) * 2)
    assert cache.find("model-older") is not None  # Somebody has asked for it.
    await cache.fill("model-newest", make_large)
    assert sorted(names(tmp_path)) == ["model-new", "model-newest", "model-older"]


async def test_what_may_be_running_or_is_being_made_stays_whatever_the_clock_says(tmp_path):
    async def make_beside_others(staging: Path):
        for name in names(tmp_path):
            os.utime(tmp_path / name, (0, 0))
        await BuildCache(tmp_path, size_bytes=1).fill("model-d", make)
        await make(staging)

    (tmp_path / "model-killed.building").mkdir()
    for name in ("model-a", "model-b"):
        await BuildCache(tmp_path, size_bytes=1).fill(name, make)
    await BuildCache(tmp_path, size_bytes=1).fill("model-c", make_beside_others)
    assert sorted(names(tmp_path)) == ["model-a", "model-b", "model-c", "model-d"]


def test_a_disk_that_is_full_is_no_mistake_in_documents_or_engine():
    said = "engine.cpp: fatal error: error writing to /tmp/ccA.s: No space left on device"
    error = internal_error("the engine", said, 1, Path("engine.cpp"))
    assert (error.code, error.message) == ("AOS701", "the engine cannot be compiled: No space left on device")
