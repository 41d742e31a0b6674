import math
import random
from collections import defaultdict
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack

import msgspec
from exam.problem import Problem
from models import built_text, engine_of

from aos_runtime.clock import SystemClock
from aos_solver.child.engine import Engine
from aos_solver.emission.layout import Common
from aos_solver.mission.models.past import Evidence, Past, updated
from aos_solver.mission.models.takeover import RunningModel, Successor, Takeover

from .models import Belief, Weather, documents, initial, small_problems, stepped

STEPS = 6
MANY_S = 3600.0


class Examined(msgspec.Struct, frozen=True):
    """The differences that one model showed.

    `replay` is the greatest difference of a probability to the exact posterior, `drawn` that of the likeliest
    weather by particles, in standard errors. `kept` is the greatest difference of the joint distribution of
    what both documents have, before and after a projection, and `new` that of the weather to the initial one.
    """

    name: str
    replay: float
    foreign: int
    drawn: float
    kept: float
    new: float


class _LongClock(SystemClock):
    """Each look at it takes an hour, so that a replay takes too long."""

    def __init__(self):
        self._now_s = 0.0

    def monotonic_s(self) -> float:
        self._now_s += MANY_S
        return self._now_s


async def examined_problems(count: int, seed: int) -> AsyncIterator[Examined]:
    """Examines so many models; those whose seeds are too large give way."""
    for problem in small_problems(count, seed):
        yield await examined(problem)


async def examined(problem: Problem) -> Examined:
    source = random.Random(f"plug/{problem.name}")
    weather = Weather(source)
    # Where there are several actions the newer documents may lack the last one.
    last = len(problem.world.actions) - 1
    without = frozenset({last} if last > 0 and source.random() < 0.5 else ())
    past, truth, foreign = _past(problem, weather, without, source)
    old = await built_text(documents(problem, None))
    new = await built_text(documents(problem, weather, without))
    async with AsyncExitStack() as stack:
        running = RunningModel(1, await stack.enter_async_context(engine_of(old)))
        for evidence in past.steps:
            await updated(running.engine, evidence, past.refuted_below)
        replay = await _taken(stack, new, running, past, SystemClock())
        assert (replay.row.by, replay.row.foreign) == ("replay", foreign), (problem.name, replay.row)
        exact = await _distance(replay.model.engine, truth)
        drawn = await _drawn(stack, new, past, truth)
        projection = await _taken(stack, new, running, past, _LongClock())
        assert projection.row.by == "projection", (problem.name, projection.row)
        kept, fresh = await _projected(problem, weather, running.engine, projection.model.engine)
    return Examined(problem.name, exact, foreign, drawn, kept, fresh)


def _past(
    problem: Problem, weather: Weather, without: frozenset[int], source: random.Random
) -> tuple[Past, Belief, int]:
    past = Past()
    belief: Belief = initial(problem, weather)
    foreign = 0
    for _ in range(STEPS):
        action = source.randrange(len(problem.world.actions))
        is_lacking = action in without
        foreign += is_lacking
        after = stepped(problem, weather, belief, None if is_lacking else action)
        # What is observed is drawn as the newer documents have it.
        seen = source.choices(list(after), [sum(weights.values()) for weights in after.values()])[0]
        total = sum(after[seen].values())
        belief = {state: weight / total for state, weight in after[seen].items()}
        past.steps.append(Evidence(f"a{action}", f"a{action}", seen))
    return past, belief, foreign


async def _taken(
    stack: AsyncExitStack, new: object, running: RunningModel, past: Past, clock: SystemClock
) -> Takeover:
    engine = await stack.enter_async_context(engine_of(new))
    takeover = await Successor(RunningModel(2, engine), clock).take_over(running, past)
    assert takeover is not None
    return takeover


async def _distance(engine: Engine, truth: Belief) -> float:
    """The greatest difference of a state's probability."""
    found = await _joint(engine, Common(("at", "weather"), (), {}))
    claimed = {tuple(map(int, values.split())): weight for values, weight in found.items()}
    return max(
        abs(claimed.get(state, 0.0) - truth.get(state, 0.0)) for state in claimed.keys() | truth.keys()
    )


async def _drawn(stack: AsyncExitStack, new: object, past: Past, truth: Belief) -> float:
    """Returns how far the probability of the likeliest weather is off by particles, in standard errors."""
    engine = await stack.enter_async_context(engine_of(new))
    summary = await engine.draw_belief()
    for evidence in past.steps:
        summary = (await updated(engine, evidence, past.refuted_below)).summary
    kinds: dict[int, float] = defaultdict(float)
    for (_, kind), share in truth.items():
        kinds[kind] += share
    kind = max(kinds, key=kinds.__getitem__)
    (values,) = (each.values for each in summary.marginals if each.variable == "weather")
    spread = math.sqrt(kinds[kind] * (1 - kinds[kind]) / summary.effective_states)
    return (values.get(str(kind), 0.0) - kinds[kind]) / max(spread, 1e-9)


async def _projected(problem: Problem, weather: Weather, old: Engine, new: Engine) -> tuple[float, float]:
    common = old.layout.common_with(new.layout)
    before, after = await _joint(old, common), await _joint(new, common)
    kept = max(abs(before.get(each, 0.0) - after.get(each, 0.0)) for each in before.keys() | after.keys())
    kinds: dict[str, float] = defaultdict(float)
    for (_, kind), share in initial(problem, weather).items():
        kinds[str(kind)] += share
    found = await _joint(new, Common(("weather",), (), {}))
    return kept, max(abs(found.get(kind, 0.0) - share) for kind, share in kinds.items())


async def _joint(engine: Engine, common: Common) -> Mapping[str, float]:
    (belief,) = (await engine.export_joint(common)).beliefs[:1]
    joint: dict[str, float] = defaultdict(float)
    for weight, _, _, values in belief.rows:
        joint[values] += weight
    return joint
