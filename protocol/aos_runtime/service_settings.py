"""What a service process is told, and where it leaves word of its end."""

from __future__ import annotations

from pathlib import Path

import msgspec

__all__ = ["ServiceSettings", "fault_path"]


class ServiceSettings(msgspec.Struct, frozen=True, kw_only=True):
    """What every service is told; each adds its own. `run_dir` is absolute."""

    robot: str
    service: str
    endpoint: str
    run_dir: str


def fault_path(run_dir: str | Path, service: str) -> Path:
    """Where a service leaves the fault that ended it, a JSON `Fault`."""
    return Path(run_dir) / "faults" / f"{service}.json"
