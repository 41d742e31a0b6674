"""The surroundings that all operations of the gateway share."""

from __future__ import annotations

from pathlib import Path

import msgspec

from aos_gateway.feed import Watches
from aos_gateway.runs import RunShelf
from aos_language.reading.files import MAX_BUNDLE_BYTES

__all__ = ["Gateway"]


class Gateway(msgspec.Struct, frozen=True, kw_only=True):
    """The runs, who watches them, and the folders: of `projects` to start, and of the gateway's own files."""

    shelf: RunShelf
    watches: Watches
    projects: tuple[Path, ...]
    folder: Path
    runs: Path
    max_body_bytes: int = 2 * MAX_BUNDLE_BYTES
