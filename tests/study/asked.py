"""Questions about decisions: do they disturb, how long do they take, is what they say true?"""

import asyncio
import dataclasses
import math
import statistics
import time
from pathlib import Path
from typing import Any

import msgspec

from aos_protocol.errors import SkillError
from aos_protocol.messages import DecisionRecord, Why, WhyQuery
from aos_solver.child.engine import Engine
from aos_solver.study.flips import flip_between, is_lost
from aos_solver.study.study import Study
from aos_solver.study.valuing import Margin, Value

from .played import Beside, Played, play
from .replays import files_of

_BUNDLES = ("armadillo-rough", "armadillo-finer", "armadillo-finer-blind", "armadillo-finer-enhanced")


_SEARCH_S = 0.2
"""The budget of a searched decision."""


async def measure_undisturbed(runs: int, cache_dir: Path) -> bool:
    """Plays missions twice, once while somebody asks all the time; counts the decisions that differ."""
    compared = differing = asked = seed = 0
    while compared < runs:
        seed += 1
        files = files_of("armadillo-rough")
        budget: dict[str, Any] = {"planner": "pomcp", "simulations": 5000}
        quiet = await play(files, cache_dir, seed=seed, steps=6, **budget)
        asking = _Asking(cache_dir)
        loud = await play(
            files, cache_dir, seed=seed, steps=6, beside=Beside(asking.wait, follower=asking.follow), **budget
        )
        asked += asking.asked
        for then, now in zip(quiet.mission.decisions, loud.mission.decisions, strict=True):
            compared += 1
            differing += _decided(then) != _decided(now)
    print(f"{differing} of {compared} decisions differ; {asked} questions were answered meanwhile")
    return differing == 0 and asked > 0


def _decided(record: DecisionRecord) -> DecisionRecord:
    """The record without its times."""
    return msgspec.structs.replace(record, stamp_ns=0, planning_s=0.0, preparation_s=0.0, update_s=0.0)


class _Asking:
    """Asks why about the newest decision of a mission, again and again."""

    def __init__(self, cache_dir: Path) -> None:
        self._cache_dir = cache_dir
        self._answered = asyncio.Event()
        self.asked = 0

    async def wait(self, engine: Engine, step: int) -> None:
        """Lets a skill run until a question was answered; the next one goes on beside the next decision."""
        self._answered.clear()
        await self._answered.wait()

    async def follow(self, played: Played) -> None:
        study = Study(played, self._cache_dir, flips_s=0.05)
        try:
            while True:
                decisions = played.mission.decisions
                if decisions:
                    await study.why(WhyQuery(decisions[-1].step))
                    self.asked += 1
                    self._answered.set()
                await asyncio.sleep(0)
        finally:
            await study.close()


async def _why(played: Played, step: int, study: Study) -> tuple[Why | None, float]:
    begun_s = time.monotonic()
    try:
        return await study.why(WhyQuery(step)), time.monotonic() - begun_s
    except SkillError:
        return None, 0.0


async def measure_flips(runs: int, cache_dir: Path) -> bool:
    """Holds flips of exact decisions against planning by the mission's planner on both sides."""
    flips = right = 0
    took: list[float] = []
    worst_sum = 0.0
    for seed in range(1, 1 + math.ceil(runs / len(_BUNDLES))):
        for bundle in _BUNDLES:
            played = await play(files_of(bundle), cache_dir, seed=seed, steps=5)
            study = Study(played, cache_dir)
            try:
                for step in (made.step for made in played.mission.decisions):
                    await study.why(WhyQuery(step))
                    why, seconds = await _why(played, step, study)
                    if why is None or not why.is_exact:
                        continue
                    took.append(seconds)
                    worst_sum = max(
                        worst_sum,
                        abs(sum(term.value for term in why.terms) - why.value),
                        abs(sum(term.other for term in why.terms) - why.other_value),
                    )
                    for flip in why.flips:
                        flips += 1
                        is_right = await _is_right(
                            played, why, flip.variable, flip.value, flip.low, flip.high
                        )
                        right += is_right
                        if not is_right:
                            print(f"{bundle}, seed {seed}, step {step}: {why.action}, {why.other}, {flip}")
            finally:
                await study.close()
    print(f"{right} of {flips} flip points right to 0.001, by planning on both sides")
    slowest = max(took)
    print(
        f"why took {statistics.median(took):.2f} s, at most {slowest:.2f} s, of {len(took)} exact decisions; "
        f"terms add up to {worst_sum:.1e}"
    )
    return right == flips and worst_sum < 1e-9


async def _is_right(played: Played, why: Why, variable: str, value: str, low: float, high: float) -> bool:
    """Says whether planning gives the one action on one side and the other on the other side."""
    replay = played.replay()
    try:
        decision = await replay.go_to(why.step)
        search = replay.search_by(decision)
        await replay.engine.put_aside()
        ahead = []
        for p in (low, high):
            await replay.engine.believe(variable, value, p, from_aside=True)
            plan = await search.run(replay.engine, why.step)
            worth = {each.action: each.at_least or each.q for each in plan.actions}
            ahead.append(worth[why.action] - worth[why.other])
        return high - low <= 1e-3 and is_lost(ahead[0]) != is_lost(ahead[1])
    finally:
        await replay.close()


@dataclasses.dataclass
class _Held:
    """Decisions by POMCP: margins and intervals that hold the exact ones."""

    decisions: int = 0
    margins: int = 0
    changes: int = 0
    """Exact changes of the choice, of which `told` are in the interval that was told."""
    told: int = 0
    certain: int = 0
    """Intervals with a change for certain, of which `right` have one."""
    right: int = 0
    late_s: list[float] = dataclasses.field(default_factory=list)
    """The time of each answer beyond twice the budget."""

    async def take(self, played: Played, why: Why) -> None:
        exact = await _exact_margin(played, why)
        self.decisions += 1
        self.margins += abs(why.margin - exact.value) <= 2 * why.margin_stderr + 1e-9
        for flip in why.flips:
            place = await _exact_flip(played, why, flip.variable, flip.value, flip.now)
            is_held = place is not None and flip.low - 1e-3 <= place <= flip.high + 1e-3
            self.changes += place is not None
            self.told += is_held
            self.certain += flip.is_checked
            self.right += flip.is_checked and is_held
            if not is_held and (flip.is_checked or place is not None):
                print(f"step {why.step}: {why.action}, {why.other}, exact {place}, {flip}", flush=True)

    def is_well(self) -> bool:
        shares = ((self.margins, self.decisions), (self.told, self.changes), (self.right, self.certain))
        return self.decisions > 0 and all(held >= 0.93 * of for held, of in shares)


async def measure_intervals(runs: int, cache_dir: Path) -> bool:
    """Holds what is told of POMCP's decisions against exact values; one mission for each run."""
    held = _Held()
    for seed in range(1, runs + 1):
        files = files_of(_BUNDLES[seed % len(_BUNDLES)])
        budget: dict[str, Any] = {"planner": "pomcp", "time_s": _SEARCH_S}
        played = await play(files, cache_dir, seed=seed, steps=4, **budget)
        study = Study(played, cache_dir)
        try:
            await _why(played, 1, study)  # It starts the engine, and compiles the marks of the rewards.
            for step in (made.step for made in played.mission.decisions):
                why, seconds = await _why(played, step, study)
                if why is not None:
                    held.late_s.append(seconds - 2 * _SEARCH_S)
                    await held.take(played, why)
        finally:
            await study.close()
    print(f"{held.margins} of {held.decisions} margins are within two standard errors of the exact one")
    print(f"{held.told} of {held.changes} exact changes of the choice are in the interval that is told")
    print(f"{held.right} of {held.certain} changes for certain are there")
    print(
        f"why took {statistics.median(held.late_s):+.2f} s beside twice the budget, "
        f"at most {max(held.late_s):+.2f} s; {sum(late > 1 for late in held.late_s)} took more than 1 s"
    )
    return held.is_well()


async def _exact_margin(played: Played, why: Why) -> Margin:
    replay = played.replay()
    try:
        await replay.go_to(why.step)
        found = {each.action: each.q for each in (await replay.engine.exact_values(why.horizon)).actions}
        return Margin.of(Value(found[why.action]), Value(found[why.other]))
    finally:
        await replay.close()


async def _exact_flip(played: Played, why: Why, variable: str, value: str, now: float) -> float | None:
    replay = played.replay()
    try:
        await replay.go_to(why.step)
        await replay.engine.put_aside()

        async def margin_at(p: float) -> Margin:
            await replay.engine.believe(variable, value, p, from_aside=True)
            found = {each.action: each.q for each in (await replay.engine.exact_values(why.horizon)).actions}
            return Margin.of(Value(found[why.action]), Value(found[why.other]))

        between = await flip_between(margin_at, now)
        return None if between is None else (between[0] + between[1]) / 2
    finally:
        await replay.close()
