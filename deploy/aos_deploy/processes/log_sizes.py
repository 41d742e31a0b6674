"""The logs of a run, kept from filling the disk by a program that prints without end."""

import asyncio
from contextlib import suppress
from pathlib import Path

LOG_BYTES = 256 * 1024**2
"""A log that has become longer is cut."""
KEPT_BYTES = 1024**2
"""The end of a log that is left when it is cut."""
EVERY_S = 1.0


async def keep_logs_short(folder: Path) -> None:
    """Cuts the logs in a folder as they become too long, until it is cancelled."""
    while True:
        await asyncio.sleep(EVERY_S)
        await asyncio.to_thread(shorten_all, folder)


def shorten_all(folder: Path) -> None:
    """Cuts the logs in a folder that are too long."""
    with suppress(OSError):  # The next time will do.
        for log in folder.glob("*.log"):
            shorten(log)


def shorten(log: Path, *, most_bytes: int = LOG_BYTES, kept_bytes: int = KEPT_BYTES) -> None:
    """Cuts a log of more than `most_bytes` to a line that says so, and its last lines.

    Whoever writes it adds to its end, as files do that are opened for that. What is written in between is
    lost.
    """
    size = log.stat().st_size
    if size <= most_bytes:
        return
    with log.open("r+b") as file:
        file.seek(size - kept_bytes)
        end = file.read(kept_bytes).partition(b"\n")[2]
        file.truncate(0)
    with log.open("ab") as file:
        file.write(b"aos-up: this log had %d bytes, and was cut to its end\n" % size + end)
