"""The time that `why` takes for decisions of all planners, beside twice their budget."""

import time
from pathlib import Path
from typing import Any

from aos_protocol.messages import WhyQuery
from aos_solver.study.study import Study

from .played import play
from .replays import files_of

_BUDGET_S = 0.2
_LATE_S = 1.0
_STEPS = 4
_KINDS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("armadillo-rough", {"planner": "pomcp"}),
    ("armadillo-rough", {"planner": "despot"}),
    ("bench/tiger", {"planner": "sarsop"}),
    ("bench/rocksample-7-8", {}),
    ("bench/laser-normal", {}),
    ("bench/tag", {}),
    ("bench/maint10", {}),
)


async def measure(runs: int, cache_dir: Path) -> bool:
    """Plays so many missions of each kind, and times a question about each step, the way there included."""
    is_well = True
    for bundle, budget in _KINDS:
        late_s, planners = [], set()
        for seed in range(1, runs + 1):
            played = await play(
                files_of(bundle), cache_dir, seed=seed, steps=_STEPS, time_s=_BUDGET_S, **budget
            )
            study = Study(played, cache_dir)
            try:
                await study.why(WhyQuery(1))  # It starts the engine, and compiles the marks of the rewards.
                for step in (made.step for made in played.mission.decisions):
                    begun_s = time.monotonic()
                    planners.add((await study.why(WhyQuery(step))).planner)
                    late_s.append(time.monotonic() - begun_s - 2 * _BUDGET_S)
            finally:
                await study.close()
        slow = sum(late > _LATE_S for late in late_s)
        is_well &= not slow
        print(
            f"{bundle} by {', '.join(sorted(planners))}: {len(late_s) - slow} of {len(late_s)} within twice "
            f"the budget and {_LATE_S:g} s; at most {max(late_s):+.2f} s beside twice the budget",
            flush=True,
        )
    return is_well
