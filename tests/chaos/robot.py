"""A robot for missions that are disturbed: its skills take a while, and count each motion in a file."""

import asyncio
import os
import time
from pathlib import Path
from typing import Any

MOVES_S = float(os.environ.get("AOS_MOVES_S", "0.15"))


async def _move(call: Any):
    """Moves for a while. Begun, ended and cancelled motions are each a line of $AOS_MOTIONS."""
    _note("begun", call)
    try:
        await asyncio.sleep(MOVES_S)
    except asyncio.CancelledError:
        _note("cancelled", call)
        raise
    _note("ended", call)


async def listen(call: Any) -> dict[str, str]:
    """Hears the tiger on the left."""
    await _move(call)
    return {"loudest": "left"}


async def open_door(call: Any, door: str):
    await _move(call)


def _note(what: str, call: Any):
    with Path(os.environ["AOS_MOTIONS"]).open("a") as motions:
        motions.write(f"{what} {call.id} {time.time()}\n")
