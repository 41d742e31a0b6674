"""AOS installed from its wheel, as a user has it: commands in an environment that knows no checkout."""

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path
from typing import Any

SIMULATOR = ("pybullet", "PIL")
"""The beginnings of what the extra `sim` adds to the packages."""

_PATIENCE_S = 300.0


class Installation:
    """The commands of an environment, run in a folder that was empty at first."""

    def __init__(self, environment: Path, folder: Path, cache_dir: Path) -> None:
        self.commands = environment / "bin"
        self.folder = folder
        own = {"AOS_CACHE_DIR": str(cache_dir), "AOS_RUNNING_DIR": str(folder.parent)}
        self._place: dict[str, Any] = {
            "cwd": folder,
            "env": {**os.environ, **own},
            "stdin": subprocess.DEVNULL,
        }

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        name, *arguments = command
        line = [str(self.commands / name), *arguments]
        return subprocess.run(line, **self._place, text=True, capture_output=True, timeout=_PATIENCE_S)

    def start(self, *command: str) -> subprocess.Popen[str]:
        name, *arguments = command
        line, pipe = [str(self.commands / name), *arguments], subprocess.PIPE
        return subprocess.Popen(
            line, **self._place, text=True, stdout=pipe, stderr=pipe, start_new_session=True
        )


def built_wheel(root: Path, folder: Path, part: str = ".") -> Path:
    """The wheel of a checkout's files, or of a part of it, built in a copy: the checkout stays as it is."""
    source = folder / "source"
    inside = shutil.ignore_patterns(".*", "build", "*.egg-info", "__pycache__")
    runs = shutil.ignore_patterns("runs")
    shutil.copytree(
        root,
        source,
        ignore=lambda at, names: inside(at, names) | (runs(at, names) if at == str(root) else set()),
    )
    pip: list[str | Path] = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check"]
    subprocess.run(
        [*pip, "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir", folder, source / part],
        check=True,
        stdin=subprocess.DEVNULL,
        timeout=_PATIENCE_S,
    )
    (wheel,) = folder.glob("*.whl")
    return wheel


def install(
    wheel: Path, environment: Path, *, without: tuple[str, ...] = (), only: tuple[str, ...] = ("",)
) -> None:
    venv.create(environment, symlinks=True)
    pip: list[str | Path] = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        environment / "bin" / "python",
        "install",
    ]
    options = ["--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
    subprocess.run([*pip, *options, wheel], check=True, stdin=subprocess.DEVNULL, timeout=_PATIENCE_S)
    link_packages(environment, without=without, only=only)


def link_packages(
    environment: Path, *, without: tuple[str, ...] = (), only: tuple[str, ...] = ("",)
) -> list[Path]:
    """Links packages from the environment of the tests, which has them already; returns the links.

    They are those that begin with one of `only`, and with none of `without`.
    """
    (packages,) = environment.glob("lib/python*/site-packages")
    (available,) = Path(sys.prefix).glob("lib/python*/site-packages")
    links = []
    for package in available.iterdir():
        ours = package.name.startswith(("aos", "__editable__", "_", *without)) or package.suffix == ".pth"
        if package.name.startswith(only) and not ours and not (packages / package.name).exists():
            (packages / package.name).symlink_to(package)
            links.append(packages / package.name)
    return links
