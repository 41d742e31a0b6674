"""A host that is reached by ssh: this machine, by a real SSH server or by a stand-in for one.

The server listens on loopback and knows one key, made for the test. The program `ssh` that a test puts on the
PATH tells the real one where all that is.
"""

import getpass
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from processes import HANG_S

# As sshd it ends the command's input when it is ended, and nothing else of it.
STAND_IN = """#!{python}
import os, signal, socket, subprocess, sys, threading

words = sys.argv[1:]
while words and words[0].startswith("-"):
    option = words.pop(0)
    value = words.pop(0) if option in ("-o", "-R") else ""
    if option == "-R":
        _, port, there, there_port = value.split(":")
host, command = words
assert host == "robot@arm", host

def pump(one, other):
    while data := one.recv(65536):
        other.sendall(data)
    other.shutdown(socket.SHUT_WR)

def carry():
    with socket.create_server(("127.0.0.1", int(port))) as server:
        while True:
            one = server.accept()[0]
            other = socket.create_connection((there, int(there_port)))
            for pair in ((one, other), (other, one)):
                threading.Thread(target=pump, args=pair, daemon=True).start()

threading.Thread(target=carry, daemon=True).start()
os.environ["SSH_CONNECTION"] = "stand-in"
child = subprocess.Popen(["sh", "-c", command], start_new_session=True)
signal.signal(signal.SIGTERM, lambda *_: os._exit(255))
sys.exit(child.wait() % 256)
"""


def stand_in(folder: Path) -> str:
    return _program(folder, STAND_IN.format(python=sys.executable))


def slow_stand_in(folder: Path) -> str:
    slow = """
import pathlib, time

def written():
    return {path.stat().st_ino for path in pathlib.Path("runs").glob("*/run.json")}

if "-G" in sys.argv:
    first = written()
    while not first or written() == first:
        first = first or written()
        time.sleep(0.01)
    sys.exit(1)
"""
    return _program(folder, STAND_IN.format(python=sys.executable).replace("\nwords = ", f"{slow}\nwords = "))


def refusing_ssh(folder: Path, text: str) -> str:
    return _program(folder, f"#!/bin/sh\necho '{text}' >&2\nexit 255\n")


@contextmanager
def ssh_server(folder: Path) -> Iterator[str]:
    sshd = shutil.which("sshd", path=f"{os.environ['PATH']}:/usr/sbin")
    ssh = shutil.which("ssh")
    assert sshd is not None
    assert ssh is not None
    for name in ("host", "user"):
        command = ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(folder / name)]
        subprocess.run(command, check=True)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    (folder / "sshd_config").write_text(
        f"ListenAddress 127.0.0.1:{port}\nHostKey {folder}/host\nAuthorizedKeysFile {folder}/user.pub\n"
        f"PidFile none\nStrictModes no\nUsePAM no\nPasswordAuthentication no\n"
    )
    kind, key, _ = (folder / "host.pub").read_text().split(" ", 2)
    (folder / "known").write_text(f"[127.0.0.1]:{port} {kind} {key}\n")
    (folder / "ssh_config").write_text(
        f"Host arm\n HostName 127.0.0.1\n Port {port}\n IdentityFile {folder}/user\n"
        f" IdentitiesOnly yes\n UserKnownHostsFile {folder}/known\n"
    )
    if os.getuid() == 0:
        Path("/run/sshd").mkdir(exist_ok=True)
    program = f'#!/bin/sh\nexec {ssh} -F {folder}/ssh_config -l {getpass.getuser()} "$@"\n'
    with subprocess.Popen(
        [sshd, "-D", "-e", "-f", str(folder / "sshd_config")], stderr=subprocess.DEVNULL
    ) as server:
        try:
            _until_it_listens(port)
            yield _program(folder, program)
        finally:
            server.terminate()


def _until_it_listens(port: int) -> None:
    deadline_s = time.monotonic() + HANG_S
    while time.monotonic() < deadline_s:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
    raise TimeoutError("the SSH server does not listen")


def _program(folder: Path, text: str) -> str:
    (folder / "bin").mkdir()
    (folder / "bin" / "ssh").write_text(text)
    (folder / "bin" / "ssh").chmod(0o755)
    return str(folder / "bin")
