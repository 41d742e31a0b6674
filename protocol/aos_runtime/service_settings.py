"""The settings of a service process, and the place of its last word."""

from __future__ import annotations

from pathlib import Path

import msgspec

__all__ = ["ServiceSettings", "fault_path"]


class ServiceSettings(msgspec.Struct, frozen=True, kw_only=True):
    """The settings that every service has; each adds its own. `run_dir` is absolute."""

    robot: str
    service: str
    endpoint: str
    run_dir: str


def fault_path(run_dir: str | Path, service: str) -> Path:
    """Returns the path where a service leaves the fault that ended it, a JSON `Fault`."""
    return Path(run_dir) / "faults" / f"{service}.json"
