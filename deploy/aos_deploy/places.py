"""The places of AOS's files: what comes with it beside its code, and the cache of compiled models."""

import os
from pathlib import Path

_INSTALLED = Path(__file__).resolve().parent / "share"
_CHECKOUT = Path(__file__).resolve().parents[2]
_ROOT = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT


def shipped(path: str) -> Path:
    """A file or folder that comes along, by its path in the checkout."""
    return _ROOT / path


def deploy_files() -> dict[str, Path]:
    """The deploy files that come along, by name."""
    return {path.stem: path for path in sorted(shipped("deploy").glob("*.yaml"))}


def cache_dir() -> Path:
    """Returns the folder of compiled models: $AOS_CACHE_DIR, or `aos` in the user's cache directory."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return _named("AOS_CACHE_DIR") or Path(base) / "aos"


def gateway_folder() -> Path:
    """Returns the folder of the gateway's note, its token, and the projects that it keeps.

    It is $AOS_GATEWAY_DIR, or `gateway` in the cache directory.
    """
    return _named("AOS_GATEWAY_DIR") or cache_dir() / "gateway"


def running_folder() -> Path:
    """Returns the folder with links to the runs that go on: $AOS_RUNNING_DIR, or `running` in the cache."""
    return _named("AOS_RUNNING_DIR") or cache_dir() / "running"


def _named(variable: str) -> Path | None:
    named = os.environ.get(variable)
    return Path(named).absolute() if named else None
