import shlex
import socket

import pytest

from aos_deploy.deployment.hosts import HOST
from aos_deploy.processes import ssh_connection
from aos_deploy.processes.consequence import told_end
from aos_deploy.processes.program import Program
from aos_deploy.processes.remote import dialled, is_lost, remote_command, why_it_failed
from aos_deploy.runs.directory import RunDirectory


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (
            "robot@arm: Permission denied (publickey).",
            "Give robot@arm a key of this user (ssh-copy-id robot@arm)",
        ),
        ("Host key verification failed.", "Connect once by hand, and look at the key that robot@arm shows"),
        (
            "ssh: connect to host arm port 22: Connection refused",
            "See that it works by hand, without a password",
        ),
        (
            "Error: remote port forwarding failed for listen port 20001",
            "AllowTcpForwarding in its sshd_config",
        ),
    ],
)
def test_an_ssh_that_fails_says_why_and_what_to_do(text, hint):
    error = why_it_failed("arm", "robot@arm", 255, [text])
    assert error.message == f"arm: robot@arm cannot be reached by ssh: {text}"
    assert hint in error.hint


def test_the_reason_is_told_where_ssh_has_its_connection_made():
    reason = "ssh: connect to host arm port 22: No route to host"
    said = [reason, "mm_receive_fd: recvmsg: expected received 1 got 0"]
    error = why_it_failed("arm", "robot@arm", 255, [*said, "proxy dialer did not pass back a connection"])
    assert error.message == f"arm: robot@arm cannot be reached by ssh: {reason}"


@pytest.mark.parametrize(
    ("configuration", "is_ours"),
    [
        ("addressfamily any", True),
        ("addressfamily any\nproxyjump gate", False),
        ("addressfamily any\nproxycommand nc %h %p", False),
        ("addressfamily inet6", False),
    ],
)
def test_a_way_of_the_users_own_to_a_host_is_left_to_ssh(configuration, is_ours, tmp_path, monkeypatch):
    ssh = tmp_path / "ssh"
    ssh.write_text(f"#!/bin/sh\ntest \"$1 $2\" = '-G arm' && echo '{configuration}'\n")
    ssh.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    assert bool(dialled("arm")) == is_ours


def test_a_host_that_refuses_is_tried_until_it_answers(monkeypatch):
    with socket.socket() as host:
        host.bind(("127.0.0.1", 0))
        addresses = socket.getaddrinfo(*host.getsockname(), type=socket.SOCK_STREAM)
        looked_up: list[str] = []

        def look_up(name: str, *_: object, **__: object) -> object:
            if looked_up:
                host.listen()
            looked_up.append(name)
            return addresses

        monkeypatch.setattr(socket, "getaddrinfo", look_up)
        with ssh_connection.connected("arm", "22") as connection:
            assert connection.getpeername() == host.getsockname()
        assert looked_up == ["arm", "arm"]


def test_a_host_that_refuses_for_too_long_is_told():
    with socket.socket() as host:
        host.bind(("127.0.0.1", 0))
        with pytest.raises(ConnectionRefusedError):
            ssh_connection.connected("127.0.0.1", str(host.getsockname()[1]), for_s=0.01)


def test_the_end_of_the_program_itself_is_not_that_of_ssh():
    assert why_it_failed("arm", "robot@arm", 3, ["no power"]) is None


def test_a_connection_that_is_lost_is_told_from_a_program_that_ends():
    far, here = Program(name="arm", command=("./arm",), host="arm"), Program(name="arm", command=("./arm",))
    assert is_lost(far, 255)
    assert not is_lost(far, 1)
    assert not is_lost(here, 255)


def test_the_end_of_a_connection_is_told_with_what_ssh_said(tmp_path):
    run = RunDirectory.create(tmp_path, "r", 0)
    run.log("arm").write_text("ready\nTimeout, server arm not responding.\n")
    far = Program(name="arm", command=("./arm",), host="arm")
    assert told_end(far, run, 255).startswith("exit status 255, arm: arm cannot be reached by ssh: Timeout")
    assert told_end(far, run, 1) == "exit status 1"
    run.close()


@pytest.mark.parametrize(
    "host", ["arm", "robot@arm.local", "robot@10.0.0.7", "ssh://robot@arm:2222", "[::1]"]
)
def test_hosts_are_written_as_ssh_takes_them(host):
    assert HOST.fullmatch(host)


@pytest.mark.parametrize("host", ["-oProxyCommand=x", "arm; reboot", "", "$(reboot)", "robot@-x", "a b"])
def test_nothing_else_is_a_host(host):
    assert not HOST.fullmatch(host)


def test_words_of_the_deploy_file_reach_the_other_shell_as_they_are(tmp_path):
    settings = tmp_path / "arm.json"
    settings.write_text('{"it": "isn\'t $HOME"}')
    variables = {"AOS_ENDPOINT": "tcp/127.0.0.1:7447", "AOS_ROBOT": "r", "AOS_SETTINGS": str(settings)}
    words = ("./arm", "two words", "$(reboot)")
    program = Program(name="arm", command=words, host="arm", folder="/opt/the arm")
    command = remote_command(program, "tcp/127.0.0.1:7447", variables, settings, ["-o", "Port=1"])
    assert command[2:4] == ["-o", "Port=1"], "of two values ssh takes the first"
    forward = command[command.index("-R") + 1]
    assert forward.startswith("127.0.0.1:")
    assert forward.endswith(":127.0.0.1:7447")
    *_, shell, option, script = shlex.split(command[-1])
    assert (shell, option) == ("sh", "-c")
    port = forward.split(":")[1]
    for part in (
        "cd '/opt/the arm'",
        "./arm 'two words' '$(reboot)'",
        f"AOS_ENDPOINT=tcp/127.0.0.1:{port}",
        shlex.quote(settings.read_text()),
    ):
        assert part in script
    assert str(settings) not in script
