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
    if named := os.environ.get("AOS_CACHE_DIR"):
        return Path(named).absolute()
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "aos"
