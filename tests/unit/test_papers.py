import importlib.util
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest
from packaging.requirements import Requirement
from places import DEPLOY, ROOT

from aos_deploy.deployment.parts import BusPart, DeployFile, MissionPart, SolverPart
from aos_protocol import __version__, keys, messages
from aos_protocol.errors import CODES
from aos_protocol.keys import FixedKey, Keys, Lack, Serving
from aos_solver.mission.rules.failures import SkillRule

LOCKS = ("build", "runtime", "dev", "compiler")
FIRST_SCREEN_LINES = 30


def requirements(lock: Path) -> dict[str, list[str]]:
    entries = re.split(r"\n(?=[a-z])", lock.read_text(encoding="utf-8").replace("\\\n", " "))
    return {
        Requirement(entry.split("--hash")[0]).name: re.findall(r"--hash=(\S+)", entry) for entry in entries
    }


def test_readme_shows_exactly_two_commands_on_its_first_screen():
    first_screen = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()[:FIRST_SCREEN_LINES]
    commands = [line for line in first_screen if line.startswith("./setup.sh")]
    assert commands == [
        "./setup.sh && .venv/bin/aos-up deploy/armadillo.yaml",
        "./setup.sh --dev && tests/check.sh",
    ]


@pytest.mark.parametrize("number", [1, 2])
def test_scripts_find_each_command_in_readme(number):
    script = [str(ROOT / "tests" / "readme_command.sh"), str(number)]
    found = subprocess.run(script, capture_output=True, text=True, check=True).stdout
    assert found.startswith("./setup.sh")
    assert found.count("\n") == 1


@pytest.mark.parametrize("script", ["setup.sh", "tests/check.sh", "tests/newcomer.sh", ".ci/run"])
def test_scripts_can_be_run(script):
    assert (ROOT / script).stat().st_mode & 0o111


def test_the_table_of_keys_holds_every_key_that_can_be_built():
    robot = Keys("ROBOT")
    built = {robot.live("SERVICE"), robot.activate("SKILL"), robot.call("PATH"), robot.topic("PATH")}
    built |= {robot.cancel("PATH"), robot.progress("PATH")}
    built |= {robot.serve(Serving("ADAPTER", "VERSION", "INSTANCE", "PATH"))}
    built |= {robot.lack(Lack("ADAPTER", "REASON", "PATH")), robot.returning("PROGRAM")}
    built |= {getattr(robot, name) for name, kind in vars(Keys).items() if isinstance(kind, FixedKey)}
    stand_ins = [("ROBOT", "<robot>"), ("SERVICE", "<service>"), ("SKILL", "<skill>"), ("PATH", "<path>")]
    stand_ins += [
        ("ADAPTER", "<adapter>"),
        ("VERSION", "<version>"),
        ("INSTANCE", "<instance>"),
        ("REASON", "<reason>"),
        ("PROGRAM", "<program>"),
    ]
    documented = set(re.findall(r"^ +(aos/\S+)", keys.__doc__ or "", re.MULTILINE))
    for key in built:
        if key.endswith("*"):
            continue
        for actual, shown in stand_ins:
            key = key.replace(actual, shown)
        assert key in documented
        documented.discard(key)
    assert not documented


def test_every_message_in_the_table_of_keys_exists():
    said = re.findall(r"\b[A-Z]\w+$|\b[A-Z]\w+(?= ->)", keys.__doc__ or "", re.MULTILINE)
    assert said
    for name in said:
        assert issubclass(getattr(messages, name), messages.Message)


def test_every_error_code_that_is_used_has_a_meaning():
    sources = [
        *(ROOT / "protocol").rglob("*.py"),
        *(ROOT / "services").rglob("*.?pp"),
        *(DEPLOY).rglob("*.py"),
    ]
    sources += (ROOT / "services").rglob("*.py")
    used = {
        code for path in sources for code in re.findall(r"\bAOS\d{3}\b", path.read_text(encoding="utf-8"))
    }
    assert used <= CODES.keys()


def test_a_limit_that_has_left_the_sources_is_an_error(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    table = importlib.import_module("limits_table")
    assert table.value_at("aos_runtime.bus.config.LEASE_S") == 2.0
    assert table.value_at("planning/listed/state_lister.hpp:states") == 400_000
    for place in ("aos_runtime.bus.config.LEASES", "planning/listed/state_lister.hpp:stats", "aos_x.y.Z"):
        with pytest.raises(AttributeError, match="any more"):
            table.value_at(place)


@pytest.mark.parametrize("part", [DeployFile, BusPart, MissionPart, SolverPart, SkillRule])
def test_the_page_of_the_deploy_file_has_every_key_with_its_default(part):
    page = (ROOT / "docs" / "deploy-file.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith(("| ", "## "))]
    for field in msgspec.structs.fields(part):
        row = next(line for line in rows if f"`{field.name}`" in line)
        default = field.default
        if isinstance(default, str | int | float) and not isinstance(default, bool) and default:
            assert f"{default:g}" in row if isinstance(default, float) else str(default) in row


def test_the_changelog_knows_the_version():
    assert __version__ in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", LOCKS)
def test_locks_pin_by_hash_and_hold_no_address(name):
    lock = DEPLOY / "lock" / f"{name}.txt"
    assert "://" not in lock.read_text(encoding="utf-8")
    for package, hashes in requirements(lock).items():
        assert hashes, f"{package} has no hash"


def test_locks_hold_every_dependency():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    runtime, dev, compiler = (
        pins(DEPLOY / "lock" / f"{name}.txt") for name in ("runtime", "dev", "compiler")
    )
    for pinned, lines in (
        (runtime, [*project["dependencies"], *extras["sim"], *extras["page"]]),
        (runtime | dev, extras["dev"]),
        (compiler, extras["compiler"]),
    ):
        for line in lines:
            wanted = Requirement(line)
            assert pinned[canonical(wanted.name)] in wanted.specifier, line


def test_the_development_lock_pins_only_what_the_runtime_one_does_not():
    runtime, dev = (pins(DEPLOY / "lock" / f"{name}.txt") for name in ("runtime", "dev"))
    assert runtime.keys().isdisjoint(dev)


@pytest.mark.parametrize(
    ("wheel", "can_run"),
    [
        ("https://a.b/numpy-2.4.6-cp311-cp311-manylinux_2_27_x86_64.manylinux_2_28_x86_64.whl", True),
        ("https://a.b/typer-0.28.0-py3-none-any.whl", True),
        ("https://a.b/rpds_py-1-cp313-cp313-musllinux_1_2_aarch64.whl", False),
        ("https://a.b/tree_sitter_cpp-0.23-cp39-abi3-manylinux_2_17_aarch64.whl", True),
        ("https://a.b/numpy-2.4.6-cp311-cp311-win_amd64.whl", False),
        ("https://a.b/numpy-2.4.6-cp311-cp311-macosx_14_0_arm64.whl", False),
        ("https://a.b/numpy-2.4.6-cp310-cp310-manylinux_2_27_x86_64.whl", False),
        ("https://a.b/numpy-2.4.6-cp314-cp314t-manylinux_2_27_x86_64.whl", False),
        ("https://a.b/numpy-2.4.6-cp311-cp311-manylinux_2_31_riscv64.whl", False),
    ],
)
def test_locks_have_the_wheels_of_the_machines_and_pythons_that_aos_runs_with(wheel, can_run):
    assert lock_files().can_run(wheel) is can_run


def test_locks_have_sources_only_of_what_may_have_to_be_built():
    def hashed(*wheels: str) -> list[str]:
        files = [{"url": f"https://a.b/{name}", "hashes": {"sha256": name}} for name in (*wheels, "x.tar.gz")]
        return list(lock_files().digests({"wheels": files[:-1], "sdist": files[-1]}))

    assert hashed(pure := "x-1-py3-none-any.whl") == [pure]
    assert hashed(built := "x-1-cp311-cp311-manylinux_2_17_x86_64.whl") == [built, "x.tar.gz"]


def lock_files() -> Any:
    source = importlib.util.spec_from_file_location("lock_files", DEPLOY / "lock_files.py")
    assert source is not None
    assert source.loader is not None
    module = importlib.util.module_from_spec(source)
    source.loader.exec_module(module)
    return module


def pins(lock: Path) -> dict[str, str]:
    """Package -> version, for this Python."""
    found = {}
    for line in lock.read_text(encoding="utf-8").splitlines():
        pinned = Requirement(line.partition(" --hash=")[0])
        if pinned.marker is None or pinned.marker.evaluate():
            found[canonical(pinned.name)] = next(iter(pinned.specifier)).version
    return found


def canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
