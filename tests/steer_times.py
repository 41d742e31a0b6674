"""Times of steering: `python -m tests.steer_times`, or `--times 30`.

A mission of a real system is held while a search of some seconds goes on, and while a skill runs whose robot
waits for a turn; then missions are stopped while a skill runs. Told is how long each took, and how many
decisions were made after a hold was answered. Exit code 1: a decision was made after a hold, or a stop took
longer than a second.
"""

import argparse
import asyncio
import random
import statistics
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from gateway import slow_system

from aos_protocol.access import OPERATOR
from aos_protocol.messages import BundleReport, DecisionRecord, MissionState
from aos_runtime.client import AosClient

CACHE = Path(__file__).resolve().parents[1] / ".compiled"
_SEARCH = 300_000
"""The simulations of a search of a second or more."""
_STOP_S = 1.0

_Event = DecisionRecord | MissionState | BundleReport


class Followed:
    """A system, and what was heard of it."""

    def __init__(self, client: AosClient, folder: Path) -> None:
        self.client = client
        self.heard: list[tuple[float, _Event]] = []
        self._news = asyncio.Event()
        self._turns = folder / "turns"

    async def follow(self) -> None:
        async for event in self.client.follow(stays=True):
            self.heard.append((time.monotonic(), event))
            self._news.set()

    async def until(self, phase: str, since: int) -> float:
        """The time at which the mission was in a phase, heard from a place on."""
        return await self._heard(
            lambda event: isinstance(event, MissionState) and event.phase == phase, since
        )

    async def _heard(self, is_meant: Callable[[_Event], bool], since: int) -> float:
        while True:
            for heard_s, event in self.heard[since:]:
                if is_meant(event):
                    return heard_s
            self._news.clear()
            await self._news.wait()

    def give_turn(self) -> None:
        """Lets the skill that runs come to its end."""
        with self._turns.open("w") as turns:
            turns.write("x")

    def decisions(self, since: int) -> int:
        """The decisions that were heard of from a place on."""
        return sum(
            isinstance(event, DecisionRecord) and event.outcome is None for _, event in self.heard[since:]
        )


@asynccontextmanager
async def followed(folder: Path, simulations: int) -> AsyncIterator[Followed]:
    """A system that stays, whose mission has made its first decision."""
    with slow_system(folder, CACHE, "--stay", simulations=simulations) as run:
        async with AosClient.of_run(run, OPERATOR) as client:
            system = Followed(client, folder)
            following = asyncio.create_task(system.follow())
            try:
                await system.until("acting", 0)
                yield system
            finally:
                following.cancel()


async def held_in_a_search(system: Followed, times: int) -> tuple[list[float], int]:
    """The times until a mission holds whose search goes on, and the decisions after the answers."""
    took, after = [], 0
    since = len(system.heard)
    system.give_turn()
    for _ in range(times):
        await system.until("planning", since)
        await asyncio.sleep(random.uniform(0.0, 0.5))
        since, begun_s = len(system.heard), time.monotonic()
        await system.client.hold()
        answered = len(system.heard)
        took.append(await system.until("holding", since) - begun_s)
        after += system.decisions(answered)
        since = len(system.heard)
        await system.client.resume()
    return took, after


async def held_in_a_skill(system: Followed, times: int) -> tuple[list[float], int]:
    """The times from the end of a skill until the mission holds, and the decisions after the answers."""
    took, after = [], 0
    for _ in range(times):
        since = len(system.heard)
        await system.client.hold()
        begun_s = time.monotonic()
        system.give_turn()
        took.append(await system.until("holding", since) - begun_s)
        after += system.decisions(since)
        since = len(system.heard)
        await system.client.resume()
        await system.until("acting", since)
    return took, after


async def stopped(system: Followed, times: int) -> list[float]:
    """The times until missions have ended that are stopped while a skill runs."""
    took = []
    for _ in range(times):
        begun_s = time.monotonic()
        state = await system.client.stop_mission()
        took.append(time.monotonic() - begun_s)
        assert state.ending == "cancelled", state
        since = len(system.heard)
        await system.client.start_mission()
        await system.until("acting", since)
    return took


def _told(what: str, took: Sequence[float]) -> None:
    print(f"{what}: {statistics.median(took):.3f} s in the median, at most {max(took):.3f} s of {len(took)}")


async def measure(times: int) -> bool:
    """Measures and tells all of it."""
    with tempfile.TemporaryDirectory() as folder:
        async with followed(Path(folder), _SEARCH) as system:
            in_search, after_search = await held_in_a_search(system, times)
    with tempfile.TemporaryDirectory() as folder:
        async with followed(Path(folder), 100) as system:
            in_skill, after_skill = await held_in_a_skill(system, times)
            stops = await stopped(system, times)
    _told("a hold while a search goes on", in_search)
    _told("a hold while a skill runs, from the skill's end", in_skill)
    print(f"{after_search + after_skill} decisions after {2 * times} answers")
    _told("a stop while a skill runs", stops)
    return after_search + after_skill == 0 and max(stops) <= _STOP_S


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.steer_times", description=__doc__)
    parser.add_argument("--times", type=int, default=30, help="how often each is measured")
    return 0 if asyncio.run(measure(parser.parse_args().times)) else 1


if __name__ == "__main__":
    sys.exit(main())
