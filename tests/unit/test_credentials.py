import fcntl
import os
import shutil
import socket as sockets
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from commands import aos
from places import ROOT
from processes import finished

from aos_deploy.processes.passes import Outsider, Passes
from aos_deploy.runs.bus_socket import place_of_socket, remove_left_sockets, remove_socket
from aos_deploy.runs.directory import RunDirectory
from aos_protocol.access import ADAPTER, OPERATOR, SOLVER, WATCHER, Party
from aos_protocol.errors import BusError, DeployError
from aos_runtime.bus.credentials import Credential, credential_of_environment, credential_of_run
from aos_runtime.client import AosClient

ARM = Party(name="arm", role=ADAPTER, paths=("/pick",))


@pytest.fixture
def run(tmp_path) -> RunDirectory:
    return RunDirectory.create(tmp_path, "r", 0)


async def test_a_folder_that_is_no_run_is_named_once(tmp_path: Path):
    with pytest.raises(BusError) as caught:
        await AosClient.of_run(tmp_path).__aenter__()
    assert caught.value.message == f"{tmp_path} is no run directory: run.json: No such file or directory"


async def test_a_client_of_a_run_that_has_ended_is_told_so(run: RunDirectory):
    (run.path / "run.json").write_text('{"endpoint": "tcp/127.0.0.1:1", "robot": "r"}')
    (run.path / "summary.json").write_text("{}")
    with pytest.raises(BusError) as caught:
        await AosClient.of_run(run.path, connect_timeout_s=0.1).__aenter__()
    assert caught.value.message == f"{run.path} is over"


def test_each_party_has_a_password_in_a_file_of_its_own(run: RunDirectory):
    passes = Passes(run, [Party(name=SOLVER, role=SOLVER), ARM])
    names = (SOLVER, "arm", OPERATOR, WATCHER)
    credentials = [credential_of_run(run.path, name) for name in names]
    assert credentials == [passes.credential(name) for name in names]
    assert len({credential.password for credential in credentials if credential}) == 4
    assert {passes.file(name).stat().st_mode & 0o777 for name in names} == {0o600}
    assert passes.file("arm").parent.stat().st_mode & 0o777 == 0o700
    passes.write_dictionary()
    assert passes.dictionary.read_text().splitlines() == [
        f"{name}:{passes.credential(name).password}" for name in names
    ]
    assert passes.dictionary.stat().st_mode & 0o777 == 0o600


def test_an_outsider_keeps_his_password_from_run_to_run(tmp_path):
    file = tmp_path / "arm.password"
    first, second = (
        Passes(RunDirectory.create(tmp_path, "r", 0), [], [Outsider(ARM, file)]) for _ in range(2)
    )
    assert first.credential("arm") == second.credential("arm")
    assert first.credential(OPERATOR) != second.credential(OPERATOR)
    assert file.stat().st_mode & 0o777 == 0o600
    file.chmod(0o640)
    with pytest.raises(DeployError, match=r"others can read the credential .*Run chmod 600"):
        Passes(RunDirectory.create(tmp_path, "r", 0), [], [Outsider(ARM, file)])


def test_a_program_finds_its_credential_in_its_environment(tmp_path):
    (tmp_path / "password").write_text("secret\n")
    variables = {"AOS_USER": "arm", "AOS_PASSWORD_FILE": str(tmp_path / "password")}
    credential = credential_of_environment(variables)
    assert credential == Credential("arm", "secret")
    assert "secret" not in repr(credential)
    assert credential_of_environment({"AOS_USER": "arm"}) is None
    with pytest.raises(BusError, match="cannot be read"):
        credential_of_environment({**variables, "AOS_PASSWORD_FILE": str(tmp_path / "none")})


def test_the_bus_is_in_the_run_directory_or_where_its_path_is_short_enough(tmp_path, monkeypatch):
    # The folders of tests may have long paths themselves.
    with tempfile.TemporaryDirectory(dir="/tmp") as name:
        short = Path(name)
        monkeypatch.setenv("XDG_RUNTIME_DIR", name)
        assert place_of_socket(short) == short / "bus"
        for folder in (tmp_path / ("long" * 30), tmp_path / "with space", tmp_path / "with?mark"):
            socket = place_of_socket(folder)
            assert socket.parent.parent == short
            assert socket.parent.stat().st_mode & 0o777 == 0o700
            socket.touch()
            remove_socket(socket)
            assert not socket.parent.exists()


@pytest.mark.parametrize("written", ["{command: [python], credential: x}", "{external: '', credential: 3}"])
def test_a_credential_is_a_file_of_an_external_adapter(tmp_path, written):
    deploy = tmp_path / "r.yaml"
    deploy.write_text(
        f"aos: 1\nrobot: r\nbundles: [{ROOT}/deploy/bundles/armadillo-finer]\n"
        f"adapters:\n  arm: {written}\nbind: {{'*': arm}}\n"
    )
    result = aos("doctor", deploy)
    assert result.exit_code != 0
    assert "credential" in f"{result.output}{result.exception}"


def test_a_unit_starts_a_mission_with_the_machine(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "base_prefix", "/home/robot/.pyenv/versions/3.11")
    deploy = tmp_path / "r.yaml"
    deploy.write_text(
        f"aos: 1\nrobot: r\nproject: armadillo\nbundles: [{ROOT}/deploy/bundles/armadillo-finer]\n"
        "bind: {'*': model}\n"
    )
    result = aos("new", "unit", deploy, "--to", tmp_path, "--user", "robot")
    assert result.exit_code == 0, result.output
    unit = tmp_path / "aos-r.service"
    lines = unit.read_text().splitlines()
    for line in (
        "User=robot",
        "NoNewPrivileges=yes",
        "ProtectSystem=strict",
        "ProtectHome=read-only",
        f"ReadWritePaths={tmp_path}/runs",
    ):
        assert line in lines
    assert any(line.startswith("ExecStart=") and line.endswith(f"aos-up {deploy} --plain") for line in lines)
    again = aos("new", "unit", deploy, "--to", tmp_path)
    assert again.exit_code != 0
    if shutil.which("systemd-analyze") is None:
        pytest.skip("needs systemd-analyze, which reads the unit as systemd does")
    done = finished("systemd-analyze", "verify", unit)
    assert unit.name not in done.stderr.replace("Failed to prepare filename", ""), done.stderr
    # Tenths of systemd's scale, from 0 to 10.
    rated = ["systemd-analyze", "security", "--offline=true", "--threshold=25", unit]
    done = finished(*rated)
    assert done.returncode == 0, done.stdout


@pytest.fixture
def short_folder() -> Iterator[Path]:
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        yield Path(folder)


def test_the_folder_of_a_socket_whose_owner_was_killed_is_removed_and_no_other(
    short_folder: Path, monkeypatch
):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(short_folder))
    names = ("killed", "listened", "locked", "filled")
    folders = {name: short_folder / f"aos-bus-{name}" for name in names}
    living = []
    for name, folder in folders.items():
        folder.mkdir()
        bound = sockets.socket(sockets.AF_UNIX)
        bound.bind(str(folder / "bus"))
        if name == "listened":
            bound.listen()
            living.append(bound)
        else:
            bound.close()  # What is left of it is the file.
    (folders["filled"] / "else").touch()
    os.utime(folders["locked"], (0, 0))  # No clock counts.
    lock = os.open(folders["locked"], os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    remove_left_sockets()
    os.close(lock)
    living[0].close()
    assert {name for name, folder in folders.items() if folder.exists()} == set(names) - {"killed"}
    assert (folders["filled"] / "else").exists()


def test_a_folder_that_is_being_made_is_not_taken_for_one_that_was_left(short_folder: Path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(short_folder))
    run = short_folder / ("long" * 30)
    stopping = threading.Event()

    def remove():
        while not stopping.is_set():
            remove_left_sockets()

    with ThreadPoolExecutor() as threads:
        removing = threads.submit(remove)
        try:
            for _ in range(300):
                socket = place_of_socket(run)
                assert socket.parent.is_dir()
                remove_socket(socket)
        finally:
            stopping.set()
        removing.result()
