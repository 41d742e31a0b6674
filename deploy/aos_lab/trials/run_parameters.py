"""The values of mission parameters that a run's mission had, as its journal says."""

from __future__ import annotations

from pathlib import Path

import msgspec

from aos_protocol.messages import MissionBegun
from aos_runtime.journal import Journal

__all__ = ["mission_parameters_of"]


def mission_parameters_of(run: Path) -> dict[str, str]:
    """The values by the names of parameters' parts; none where no mission began."""
    path = run / "journal.db"
    if not path.is_file():
        return {}
    with Journal.read(path) as journal:
        for row in journal.rows("begun"):
            return msgspec.json.decode(row.payload, type=MissionBegun).mission_parameters
    return {}
