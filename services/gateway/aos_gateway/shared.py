"""The surroundings that all operations of the gateway share."""

import asyncio
from pathlib import Path

import msgspec

from aos_gateway.metrics.counting import Metrics
from aos_gateway.runs.drawings import Drawings
from aos_gateway.runs.feed import Watches
from aos_gateway.runs.shelf import RunShelf
from aos_gateway.runs.trace import Traces
from aos_language.reading.files import MAX_BUNDLE_BYTES


class Gateway(msgspec.Struct, frozen=True, kw_only=True):
    """The runs, who watches them, and the folders: of `projects` to start, and of the gateway's own files.

    Without `metrics` nobody can read any. Studies of missions that are over take turns (`studying`): each has
    engines of its own.
    """

    shelf: RunShelf
    watches: Watches
    projects: tuple[Path, ...]
    folder: Path
    runs: Path
    studying: asyncio.Semaphore
    traces: Traces
    drawings: Drawings
    metrics: Metrics | None = None
    max_body_bytes: int = 2 * MAX_BUNDLE_BYTES
