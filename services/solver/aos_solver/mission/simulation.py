"""Whole missions without a robot: the world is a hidden state that the documents' own model steps.

The mission is the same as with a robot; its ports are other ones. Rewards are the model's, so that returns
can be compared. A mission with a robot knows its belief alone; here the world is known too, and so whether
the belief was right.
"""

import sys

import msgspec
from msgspec.structs import replace

from aos_protocol.errors import DocumentError
from aos_protocol.messages import Activate, DecisionRecord, Outcome
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.endings import Ending, MissionLimits, believed_ending
from aos_solver.mission.rules.failures import FailureRules
from aos_solver.mission.rules.terms import Terms

_NO_CONSEQUENCES = FailureRules(failure_limit=sys.maxsize, set_aside_after=sys.maxsize)
"""A model's skills never break. Where the world has other documents, their reports are left to the belief."""


class SimulatedRun(msgspec.Struct, frozen=True, rename={"total": "return"}):
    """One mission: `total` is the undiscounted return (`return` in JSON).

    `ending` is why it stopped: what the belief called for, or the world's end where the belief has not
    noticed it. `world_ending` is the truth: how the world has ended, None where it has not. `believed_ending`
    is what the last belief held for sure enough. `numbers` are what were observed beside each response,
    where a model reports any, and `monitors` what monitors said after each step. `states` are texts of the
    world's state before the first action and after each, where they were wanted. `violated` are the mission's
    constraints that were violated in the world, and `risked` is what the decisions took of each constraint's
    budget.
    """

    seed: int
    total: float
    discounted_return: float
    ending: Ending
    steps: int
    actions: tuple[str, ...]
    observations: tuple[str, ...]
    states: tuple[str, ...] = ()
    world_ending: Ending | None = None
    believed_ending: Ending | None = None
    numbers: tuple[dict[str, float | list[float | None]], ...] = ()
    violated: tuple[str, ...] = ()
    risked: dict[str, float] = {}
    monitors: tuple[dict[str, str], ...] = ()


async def simulate_mission(
    engine: Engine,
    search: Search,
    limits: MissionLimits,
    *,
    with_states: bool = False,
    world: Engine | None = None,
) -> SimulatedRun:
    """Runs one mission from the initial belief; `search.seed` also draws the world.

    `world` plays the world where the robot's model may be wrong about it: the engine of other documents with
    the same actions. Rewards and endings are then theirs. An AosError ends it.
    """
    await engine.reset_belief(search.seed)
    played = _World(world or engine, engine.description.discount, with_states)
    await played.begin(search.seed)
    terms = Terms(
        name="simulated",
        limits=limits,
        # Nothing takes time in this world, so that there is none to look ahead in.
        search=replace(search, step_limit=limits.step_limit, ponder_while_acting=False),
        failures=_NO_CONSEQUENCES,
        is_cautious=False,
    )
    mission = Mission(terms, RunningModel(0, engine), played)
    await mission.run_or_raise()
    return SimulatedRun(
        seed=search.seed,
        total=played.total,
        discounted_return=played.discounted,
        ending=Ending(mission.state.ending),
        steps=len(played.actions),
        actions=tuple(played.actions),
        observations=tuple(played.responses),
        states=tuple(played.states),
        world_ending=played.world_ending,
        believed_ending=believed_ending(mission.belief, limits),
        numbers=tuple(played.numbers) if any(played.numbers) else (),
        monitors=tuple(played.monitors) if any(played.monitors) else (),
        violated=tuple(
            bound.never for number, bound in enumerate(engine.bounds) if played.violations >> number & 1
        ),
        risked={bound.never: played.risked.get(bound.never, 0.0) for bound in engine.bounds},
    )


class _World(QuietPorts):
    """A mission's ports where skills act on the hidden state of an engine, and what came of that."""

    def __init__(self, engine: Engine, discount: float, has_states: bool) -> None:
        self._engine = engine
        self._discount = discount
        self._has_states = has_states
        self._places = {action.name: index for index, action in enumerate(engine.description.actions)}
        self.total = self.discounted = 0.0
        self.violations = 0
        self.risked: dict[str, float] = {}
        self.actions: list[str] = []
        self.responses: list[str] = []
        self.numbers: list[dict[str, float | list[float | None]]] = []
        self.monitors: list[dict[str, str]] = []
        self.states: list[str] = []

    async def begin(self, seed: int) -> None:
        """Draws the hidden state."""
        start = await self._engine.reset_world(seed)
        await self._look(start.ending)

    def publish_record(self, record: DecisionRecord) -> None:
        """Adds up what decisions risk."""
        for spent in record.constraints if record.outcome is None else ():
            self.risked[spent.never] = self.risked.get(spent.never, 0.0) + spent.risk

    async def activate(self, request: Activate, action: str) -> Outcome:
        """Steps the hidden state; DocumentError where the world's documents have no such action."""
        if action not in self._places:
            raise DocumentError(f"the world's documents have no action {action}", hint="Name others")
        step = await self._engine.step_world(self._places[action])
        self.violations |= step.violations
        self.total += step.reward
        self.discounted += self._discount ** len(self.actions) * step.reward
        self.actions.append(action)
        self.responses.append(step.response)
        self.numbers.append(step.numbers)
        await self._look(step.ending)
        monitors = await self._engine.monitor_world()
        self.monitors.append(monitors)
        return Outcome(
            request.id, request.skill, "observed", step.response, numbers=step.numbers, monitors=monitors
        )

    async def _look(self, ending: str | None) -> None:
        self.world_ending = Ending(ending) if ending else None
        if self._has_states:
            self.states.append(await self._engine.world_state())
