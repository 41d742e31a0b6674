import asyncio
import sys
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from typing import Any

import pytest
from commands import aos

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import RunRecord
from aos_gateway.runs.run import RemoteRun
from aos_gateway.runs.shelf import RunShelf
from aos_protocol.errors import GatewayError
from aos_runtime.disk.mission_folders import make_folder_of_missions


class EndingRun(RemoteRun):
    """A run that is over as soon as somebody asks it, and whose bus says nothing of that."""

    @asynccontextmanager
    async def _silent_client(self) -> AsyncIterator[Any]:
        self.is_running = False
        yield None

    def _client(self, user: str) -> Any:
        return self._silent_client()


async def test_nobody_waits_for_the_answer_of_a_run_that_has_ended():
    run = EndingRun("tcp/10.0.0.7:7447", "tiger")
    with pytest.raises(GatewayError, match="is over") as caught:
        async with run.asking():
            await asyncio.Event().wait()
    assert caught.value.code == "AOS905"


def test_systems_of_one_robot_at_files_of_one_name_have_names_of_their_own():
    endpoints = ("tcp/10.0.0.7:7447", "unixsock-stream//run/a/bus", "unixsock-stream//run/b/bus")
    shelf = RunShelf([], [RemoteRun(endpoint, "tiger") for endpoint in endpoints])
    assert [name for name in shelf.runs() if "@" in name] == [
        *("tiger@10.0.0.7:7447", "tiger@run_a_bus", "tiger@run_b_bus")
    ]


def test_a_new_run_is_there_while_somebody_makes_a_list(tmp_path):
    shelf = RunShelf([tmp_path])
    record = RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=1)
    usual_s = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        with ThreadPoolExecutor(1) as viewer:
            for second in range(200):
                listed = viewer.submit(shelf.runs)
                run = RunDirectory.create(tmp_path, "r", second * 10**9)
                run.write_record(record)
                run.close()
                assert run.path.name in shelf.runs()
                listed.result()
    finally:
        sys.setswitchinterval(usual_s)


async def test_a_system_that_stays_names_its_first_mission_before_that_begins(tmp_path):
    run = RunDirectory.create(tmp_path, "r", 0)
    run.write_record(RunRecord(robot="r", endpoint="", deploy_file="", seed=1, started="", pid=1))
    make_folder_of_missions(run.path)
    entry = await RunShelf([tmp_path]).run("latest").entry()
    run.close()
    assert entry.stays
    assert entry.missions == (f"{run.path.name}-1",)


def test_a_folder_that_is_not_there_is_told_before_anything_is_served(tmp_path):
    told = aos("serve", "--runs", tmp_path / "runs", "--projects", tmp_path, "--listen", "nowhere").stderr
    assert told.startswith(f"{tmp_path}/runs is no folder yet")
    assert told.count("no folder yet") == 1
