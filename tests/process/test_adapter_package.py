import json
import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from commands import aos
from installed import built_wheel, install
from places import BIN, ROOT
from processes import COMMAND_S, finished

NEEDED = ("zenoh", "eclipse_zenoh", "msgspec")
NOT_NEEDED = ("zenoh_ros2_sdk",)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    return built_wheel(ROOT, tmp_path_factory.mktemp("wheel"), "protocol")


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory) -> Path:
    environment = tmp_path_factory.mktemp("robot") / "environment"
    install(wheel, environment, only=NEEDED, without=NOT_NEEDED)
    return environment / "bin" / "python"


@pytest.fixture(scope="module")
def humble_python(wheel: Path, tmp_path_factory) -> Path:
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"), "versions")
    found = [*map(str, versions.glob("3.10.*/bin/python3.10")), shutil.which("python3.10") or ""]
    named = next((name for name in found if name and _runs(name)), "")
    if not named:
        pytest.skip("needs Python 3.10")
    environment = tmp_path_factory.mktemp("humble") / "environment"
    subprocess.run([named, "-m", "venv", "--without-pip", environment], check=True)
    python = environment / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet"]
    if subprocess.run([*pip, "--only-binary", ":all:", wheel], timeout=COMMAND_S).returncode != 0:
        pytest.skip("needs a package index with msgspec and zenoh for Python 3.10")
    return python


def _runs(python: str) -> bool:
    return subprocess.run([python, "-c", ""], capture_output=True).returncode == 0


def said_by(python: Path, program: str, *words: str) -> str:
    done = finished(python, "-c", program, *words, cwd=python.parent)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


IMPORT_ALL = """
import importlib, pathlib, sys, aos_protocol
root = pathlib.Path(aos_protocol.__file__).parents[1]
for file in sorted(root.rglob("*.py")):
    name = ".".join(file.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
    if not name.endswith("__main__"):
        importlib.import_module(name)
print(*sorted({name.split(".")[0] for name in sys.modules}))
"""


@pytest.mark.parametrize("which", ["python", "humble_python"])
def test_every_module_of_it_can_be_imported(which, request):
    imported = said_by(request.getfixturevalue(which), IMPORT_ALL).split()
    assert {"aos_protocol", "aos_runtime", "zenoh", "msgspec"} <= set(imported)
    assert not {"tree_sitter", "numpy", "aos_deploy", "aos_solver"} & set(imported)


@pytest.mark.parametrize("which", ["python", "humble_python"])
def test_an_adapter_of_it_runs_a_mission(which, request, tmp_path, monkeypatch):
    python = request.getfixturevalue(which)
    monkeypatch.chdir(tmp_path)
    aos("new", "project", "fetch")
    aos("new", "adapter", "class", "--in", "fetch")
    deploy = Path("fetch.yaml")
    command = json.dumps([str(python), "-m", "aos_runtime.adapters", "fetch_robot.py:Robot"])
    text = deploy.read_text()
    assert "{class: 'fetch_robot:Robot'}" in text
    deploy.write_text(text.replace("{class: 'fetch_robot:Robot'}", f"{{command: {command}}}"))
    up = [BIN / "aos-up", deploy, "--plain", "--listen", "tcp/127.0.0.1:0"]
    done = finished(*up)
    assert "mission ended: the goal is reached" in done.stdout, done.stdout + done.stderr
    assert "robot ready" in done.stdout
    log = Path("runs/latest/logs/robot.log").read_text()
    assert "serves /look, /take" in log


@pytest.mark.parametrize(
    ("words", "environment", "said"),
    [
        ([], {}, "usage: python -m aos_runtime.adapters MODULE:CLASS"),
        (["arm.py"], {}, "usage: python -m aos_runtime.adapters MODULE:CLASS"),
        (["arm:Arm"], {}, "AOS_ENDPOINT, AOS_ROBOT, AOS_ADAPTER is not in the environment"),
    ],
)
def test_a_command_that_is_wrong_is_told(python: Path, words, environment, said):
    command = [python, "-m", "aos_runtime.adapters", *words]
    done = finished(*command, env=environment)
    assert done.returncode == 2
    assert done.stderr.startswith(said)


def test_it_shares_no_file_with_what_else_is_installed(wheel: Path):
    with zipfile.ZipFile(wheel) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
    assert tops == {"aos_adapter", "aos-adapter.pth", wheel.name.split("-py3")[0] + ".dist-info"}


def test_the_modules_of_aos_itself_come_first(python: Path):
    where = "import aos_protocol; print(aos_protocol.__file__)"
    assert "aos_adapter" in said_by(python, where)
    (packages,) = python.parents[1].glob("lib/python*/site-packages")
    whole = packages / "aos_protocol"
    whole.mkdir()
    (whole / "__init__.py").touch()
    try:
        assert said_by(python, where) == str(whole / "__init__.py")
        paths = said_by(python, "import sys; print(*sys.path)")
        assert "aos_adapter" not in paths
    finally:
        shutil.rmtree(whole)


@pytest.fixture
def size_of(python: Path) -> Callable[[str], int]:
    (packages,) = python.parents[1].glob("lib/python*/site-packages")

    def size(name: str) -> int:
        (found,) = packages.glob(name)
        files = [found] if found.is_file() else found.resolve().rglob("*")
        return sum(file.stat().st_size for file in files if file.is_file())

    return size


def test_it_is_small(size_of: Callable[[str], int], tmp_path, python: Path):
    ours = sum(map(size_of, ("aos_adapter", "aos_adapter-*.dist-info", "aos-adapter.pth")))
    assert ours < 1e6
    if shutil.which("strip") is None:
        pytest.skip("needs strip, of binutils")
    library = next(python.parents[1].glob("lib/python*/site-packages/zenoh/zenoh*.so"))
    stripped = tmp_path / "stripped.so"
    subprocess.run(["strip", "--strip-unneeded", "-o", stripped, library], check=True)
    rest = sum(map(size_of, ("zenoh", "eclipse_zenoh-*", "msgspec", "msgspec-*")))
    symbols = library.stat().st_size - stripped.stat().st_size
    print(f"{ours} bytes, with what it needs {ours + rest}, of which symbols {symbols}")
    assert ours + rest - symbols < 25 * 2**20  # as `du -m` counts
