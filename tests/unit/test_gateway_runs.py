"""The names of runs in the gateway."""

from __future__ import annotations

from aos_gateway.runs import RemoteRun, RunShelf


def test_systems_of_one_robot_at_files_of_one_name_have_names_of_their_own() -> None:
    endpoints = ("tcp/10.0.0.7:7447", "unixsock-stream//run/a/bus", "unixsock-stream//run/b/bus")
    shelf = RunShelf([], [RemoteRun(endpoint, "tiger") for endpoint in endpoints])
    assert [name for name in shelf.runs() if "@" in name] == [
        *("tiger@10.0.0.7:7447", "tiger@run_a_bus", "tiger@run_b_bus")
    ]
