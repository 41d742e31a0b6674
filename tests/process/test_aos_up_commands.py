import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
from places import BIN, DEPLOY, ROOT
from processes import finished

from aos_deploy.commands.machine import examine_machine
from aos_protocol import __version__


def run(*command: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    name, *arguments = command
    return finished(BIN / name, *arguments, cwd=folder)


def test_help_has_an_example_and_every_exit_code():
    text = " ".join(run("aos-up", "--help").stdout.split())
    assert "Example: aos-up deploy/armadillo.yaml" in text
    codes = "0 the goal", "1 documents", "2 the command", "3 the machine", "4 the mission", "130 interr"
    assert [code for code in codes if code not in text] == []


def test_the_overview_names_every_command():
    text = run("aos", "--help").stdout
    names = "up", "decisions", "runs", "bundle", "lint", "inspect", "plan", "simulate", "rate", "doctor"
    assert [name for name in names if f"  {name} " not in text] == []


@pytest.mark.parametrize("command", [["aos-up"], ["aos-up", "x.yaml", "--sed", "1"], ["aos", "decide"]])
def test_wrong_usage_has_its_own_exit_code(command):
    assert run(*command).returncode == 2


@pytest.mark.parametrize(("command", "meant"), [("status", "runs"), ("stop", "down"), ("start", "up")])
def test_a_command_that_other_tools_have_is_answered_with_the_one_that_does_it(command, meant):
    assert f"Did you mean {meant!r}?" in run("aos", command).stderr


@pytest.mark.parametrize(
    ("limit", "folder", "told"),
    [
        ("-n 24", b"a", "`ulimit -n` is 24, and a mission needs 64 files that a process opens"),
        ("-f 100", b"a", "`ulimit -f` is "),
        ("-c 0", b"r\xf6bot", "r\\udcf6bot/errand.yaml' is no UTF-8"),
        ("-c 0 && export LC_ALL=C PYTHONUTF8=0", "röbot".encode(), "Set LC_ALL=C.UTF-8, and no PYTHON"),
    ],
)
def test_what_no_mission_can_run_with_is_told_before_anything_starts(limit, folder, told, tmp_path):
    deploy = tmp_path / os.fsdecode(folder) / "errand.yaml"
    deploy.parent.mkdir()
    deploy.write_text((DEPLOY / "errand.yaml").read_text().replace("bundles/", f"{ROOT}/deploy/bundles/"))
    command = f"ulimit {limit} && exec {BIN / 'aos-up'} errand.yaml"
    done = finished("sh", "-c", command, cwd=deploy.parent)
    assert done.returncode == 3
    assert told in done.stderr
    assert not (tmp_path / "runs").exists()


def test_decisions_without_a_run_say_what_to_do(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_RUNNING_DIR", str(tmp_path))
    result = run("aos", "decisions", folder=tmp_path)
    assert result.returncode == 3
    assert result.stderr.startswith("aos: AOS605: there is no run in runs. Start one with aos-up, or name")
    assert result.stderr.count("\n") == 1


def test_decisions_of_a_folder_that_is_no_run_say_so(tmp_path):
    result = run("aos", "decisions", "--run", str(tmp_path))
    assert result.returncode == 1
    assert "is not a run directory" in result.stderr


def test_the_doctor_says_what_is_there():
    findings = {finding["subject"]: finding for finding in json.loads(run("aos", "doctor", "--json").stdout)}
    assert findings["pybullet"]["state"] == "ok"
    assert findings["loopback"]["state"] == "ok"
    assert "C++ compiler" in findings


def test_the_doctor_says_where_the_loopback_interface_is_down():
    alone = ("unshare", "--user", "--map-root-user", "--net")
    if shutil.which("unshare") is None or finished(*alone, "true").returncode:
        pytest.skip("nobody gets a network of their own here")
    done = finished(*alone, BIN / "aos", "doctor", "--json")
    findings = {finding["subject"]: finding for finding in json.loads(done.stdout)}
    assert findings["loopback"]["state"] == "absent"
    assert findings["loopback"]["found"] == "127.0.0.1 cannot be reached: Network is unreachable"


def test_the_doctor_says_what_a_deploy_file_lacks(tmp_path):
    deploy = tmp_path / "room.yaml"
    deploy.write_text(
        f"aos: 1\nrobot: armadillo\nbundles: [{ROOT / 'deploy/bundles/armadillo-finer'}]\n"
        "programs: {nav: {command: [./nav]}, ls: {command: [ls]}}\nbind: {'*': model}\n"
    )
    done = run("aos", "doctor", str(deploy), "--json")
    findings = {finding["subject"]: finding for finding in json.loads(done.stdout)}
    assert done.returncode == 3
    assert (findings["ls"]["state"], findings["ls"]["found"]) == ("ok", "program ls")
    assert findings["model"]["state"] == "ok"
    assert findings["nav"]["state"] == "missing"
    assert f"there is no program ./nav in {tmp_path}" in findings["nav"]["found"]


def test_the_doctor_says_what_to_do_about_a_cache_that_cannot_be_written(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "file" / "aos"))
    (cache,) = [finding for finding in examine_machine() if finding.subject == "cache"]
    assert cache.state == "missing"
    assert "AOS_CACHE_DIR" in cache.advice


@pytest.mark.parametrize("command", ["aos", "aos-up"])
def test_every_program_tells_its_version_and_has_a_short_help(command):
    assert run(command, "--version").stdout == f"aos {__version__}\n"
    assert run(command, "-h").stdout == (told := run(command, "--help").stdout)
    assert "--install-completion" in told


@pytest.mark.parametrize(
    ("line", "completed"),
    [
        ("aos si", ["simulate"]),
        ("aos simulate --pl", ["--planner"]),
        ("aos plan --planner p", ["pomcp"]),
        ("aos-up --li", ["--listen"]),
        ("aos new example clean", ["cleanlab"]),
        ("aos new adapter py", ["python"]),
        ("aos experiment run arma", ["armadillo"]),
    ],
)
def test_a_shell_completes_commands_options_and_values(line, completed, monkeypatch):
    name = line.split()[0]
    monkeypatch.setenv(f"_{name.upper().replace('-', '_')}_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(line.split()) - 1))
    assert run(name).stdout.split() == completed
