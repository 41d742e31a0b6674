"""The tutorial of docs/adapters, followed line by line; and templates of adapters, run as they are.

The template of a command runs in test_own_programs.py, and that of a class in test_adapter_package.py.
"""

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from places import BIN, ROOT
from processes import finished


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(command: str) -> str:
    name, *arguments = shlex.split(command)
    if name == "aos-up":
        arguments += ["--listen", "tcp/127.0.0.1:0"]
    done = finished(BIN / name, *arguments)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def test_the_tutorial_can_be_followed():
    text = (ROOT / "docs/adapters/tutorial.md").read_text(encoding="utf-8")
    files = {"python": "fetch_robot.py", "yaml": "fetch.yaml"}
    commands = 0
    for language, block in re.findall(r"^```(\w+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        if language in files:
            Path(files[language]).write_text(block, encoding="utf-8")
            continue
        said = ""
        for line in block.splitlines():
            if line.startswith("$ "):
                said = run(line[2:])
                commands += 1
            else:
                assert line in said
    assert commands == 5
    assert '"response":"taken"' in Path("runs/latest/journal.db").read_bytes().decode(errors="replace")


def test_a_new_external_adapter_runs_as_it_is():
    run("aos new project fetch")
    run("aos new adapter external --in fetch")
    arguments = ["fetch.yaml", "--plain", "--listen", "tcp/127.0.0.1:0"]
    with subprocess.Popen([BIN / "aos-up", *arguments], stdout=subprocess.PIPE, text=True) as up:
        assert up.stdout is not None
        waits = "waiting, 30 s at most: look, take: no adapter answers calls of /look, /take\n"
        assert any(line == waits for line in up.stdout)
        endpoint = re.search(r'"endpoint": "(\S+)"', Path("runs/latest/run.json").read_text())
        assert endpoint is not None
        variables = {
            "AOS_ENDPOINT": endpoint[1],
            "AOS_ROBOT": "fetch",
            "AOS_ADAPTER": "robot",
            "AOS_USER": "robot",
            "AOS_PASSWORD_FILE": "robot.password",
        }
        with subprocess.Popen([sys.executable, "fetch_robot.py"], env={**os.environ, **variables}) as program:
            said = up.stdout.read()
            program.send_signal(signal.SIGTERM)
        assert up.wait() == 0, said
    assert "mission ended: the goal is reached" in said
