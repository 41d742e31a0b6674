import asyncio
import gc
from pathlib import Path

from unit.test_build import emitted_skill

from aos_solver.building.thorough_builds import ThoroughBuilds


def test_builds_that_are_ended_twice_leave_no_process_behind(tmp_path):
    for turns in range(0, 120, 3):
        asyncio.run(_ended_twice(tmp_path / str(turns), turns))
    gc.collect()  # Python warns here of processes that nobody has waited for, and the test fails.


async def _ended_twice(cache_dir: Path, turns: int):
    builds = ThoroughBuilds(cache_dir, after_s=0.0)
    builds.begin(emitted_skill(""))
    await _turn(turns)
    builds.end()
    await _turn(3)
    builds.end()
    await asyncio.gather(*builds.tasks, return_exceptions=True)
    assert not builds.tasks


async def _turn(times: int):
    for _ in range(times):
        await asyncio.sleep(0)
