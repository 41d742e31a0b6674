import asyncio
from collections.abc import Callable

import pytest
from hostile.counters import counting
from models import built_project, built_text, engine_of
from places import BUNDLES
from projects import bundle_project
from scripted_missions import Surroundings, hears_left, jammed, observed
from test_taking_up import rows_of

from aos_deploy.commands.steering import _held
from aos_deploy.deployment.mission_values import constrained, constraint_of_option
from aos_deploy.history_check.journal_rules import SteeringRules
from aos_deploy.views.lines import decision_line
from aos_protocol.errors import SteeringError
from aos_protocol.messages import ActionRefused, Activate, MissionBegun, MissionState, Outcome, Steer
from aos_protocol.mission_rows import BEGUN
from aos_solver.building.build import BuiltModel
from aos_solver.child.engine import Engine
from aos_solver.child.questions.missions import Restriction
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.records.memory import MissionMemory, folded
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules, SkillRule
from aos_solver.mission.rules.terms import Terms

OPEN_LEFT, OPEN_RIGHT = "open(door=left_door)", "open(door=right_door)"


def hears_right(request: Activate) -> Outcome:
    return observed(request, "tiger_right" if request.skill == "listen" else "opened")


class Steered(Surroundings):
    """Surroundings with an operator: `on_act` is called in mid-action, `on_hold` while the mission waits."""

    def __init__(self, robot: Callable[[Activate], Outcome] = hears_left):
        super().__init__(robot)
        self.on_act: Callable[[Activate], None] = lambda request: None
        self.on_hold = in_turn()  # A hold that nobody expects is an error.

    async def activate(self, request: Activate, action: str) -> Outcome:
        outcome = await super().activate(request, action)
        self.on_act(request)
        return outcome

    def steer(self, verb: str, *actions: str, name: str = ""):
        request = f"{verb} {' '.join(actions)} {name} {self.mission.state.step}"
        self.mission.steer(Steer(verb, actions, name, by="ana", request=request))

    @property
    def chosen(self) -> list[tuple[str, str]]:
        return [(record.action, record.chosen_by) for record in self.decisions]


async def run(
    built: BuiltModel,
    around: Steered,
    *,
    memory: MissionMemory | None = None,
    step_limit: int = 6,
    search: Search | None = None,
    rules: FailureRules | None = None,
) -> MissionState:
    """A mission without a goal, to its end; the journal says that it holds to the rule for steering."""
    memory = memory or MissionMemory()
    around.journal(BEGUN, MissionBegun("m", memory.epoch + 1, 1, 1, "digest"))
    terms = Terms(
        name="m",
        epoch=memory.epoch + 1,
        limits=MissionLimits(step_limit=step_limit, goal_probability=2.0),
        search=search or Search(simulations=500, seed=1),
        failures=rules or FailureRules(),
    )
    async with engine_of(built) as engine:
        around.mission = Mission(terms, RunningModel(1, engine), around, memory)
        return await around.mission.run()


def violations(around: Steered) -> list[str]:
    rules, found = SteeringRules(), list[str]()
    for _, payload in around.journalled:
        rules.take(payload, lambda _, text: found.append(text))
    return found


def in_turn(*answers: Callable[[], None]) -> Callable[[], None]:
    """Does one thing after the other, each time it is called."""
    left = iter(answers)
    return lambda: next(left)()


async def test_a_mission_is_held_at_the_next_decision_and_goes_step_by_step(tiger: BuiltModel):
    around = Steered()
    around.on_act = lambda request: around.steer("hold") if request.id.step == 2 else None
    held: list[MissionState] = []
    around.on_hold = in_turn(
        lambda: held.append(around.mission.state),
        lambda: around.steer("act", OPEN_LEFT),
        lambda: around.steer("step"),
        lambda: around.steer("script", OPEN_RIGHT, "listen"),
        lambda: around.steer("resume"),
    )
    state = await run(tiger, around, step_limit=7)
    assert [by for _, by in around.chosen] == [
        *("planner", "planner", "operator", "planner", "script", "script", "planner")
    ]
    assert [action for action, by in around.chosen if by != "planner"] == [OPEN_LEFT, OPEN_RIGHT, "listen"]
    assert (held[0].phase, held[0].step, held[0].held_by) == ("holding", 2, "ana")
    assert (state.ending, state.held_by) == ("step_limit", "")
    assert violations(around) == []


async def test_a_hold_during_a_search_is_told_and_nothing_of_the_search_is_done(tiger: BuiltModel):
    around = Steered()
    wishes = in_turn(lambda: None, lambda: around.steer("hold"), lambda: None, *[lambda: None] * 9)
    told: list[MissionState] = []

    def publish_state(state: MissionState):
        told.append(state)
        if state.phase == "planning":
            wishes()

    around.publish_state = publish_state
    around.on_hold = in_turn(lambda: around.steer("resume"))
    await run(tiger, around, step_limit=2)
    waiting = next(state for state in told if state.held_by)
    assert (waiting.phase, waiting.step) == ("planning", 1)
    assert waiting.remark == "the search that goes on is dropped; ana holds the mission"
    assert "the search that goes on is dropped" in _held(waiting)
    held = told[told.index(waiting) + 1]
    assert (held.phase, held.step, held.remark) == ("holding", 1, "ana holds the mission")
    assert [by for _, by in around.chosen] == ["planner", "planner"]
    assert [search.is_dropped for search in around.decisions[1].searches] == [True, False]


async def test_a_search_without_end_is_given_up_by_a_hold_and_by_an_action_of_the_operator(tiger: BuiltModel):
    around = Steered()
    wishes = in_turn(lambda: around.steer("act", "listen"), lambda: around.steer("hold"))

    def publish_state(state: MissionState):
        if state.phase == "planning" and not state.held_by and not (state.remark or state.asked):
            wishes()

    around.publish_state = publish_state
    around.on_hold = in_turn(lambda: around.steer("stop"))
    state = await run(tiger, around, search=Search(simulations=10**15, seed=1, planner="pomcp"))
    assert (state.ending, state.step) == ("cancelled", 1)
    assert around.chosen == [("listen", "operator")]
    assert around.decisions[0].searches == ()


async def test_an_action_of_the_operator_is_observed_like_any_other(tiger: BuiltModel):
    around = Steered()
    around.on_act = lambda request: around.steer("act", OPEN_LEFT) if request.id.step == 1 else None
    await run(tiger, around, step_limit=2)
    decided, observation = around.decisions[1], around.outcomes[1]
    assert (decided.actions, decided.simulations, decided.planner) == ((), 0, "")
    assert [each.response for each in decided.predicted] == ["opened"]
    assert decision_line(decided) == "step  2: open(door=left_door)  ana has asked for it"
    assert [marginal.values for marginal in around.outcomes[0].belief.marginals] != [
        marginal.values for marginal in observation.belief.marginals
    ]
    assert observation.belief.marginals[0].values == pytest.approx({"Left": 0.5, "Right": 0.5})


async def test_what_is_left_out_is_neither_decided_for_nor_looked_ahead_to(tiger: BuiltModel):
    around = Steered(hears_right)
    around.on_act = lambda request: (
        around.steer("leave_out", name=OPEN_RIGHT) if request.id.step == 1 else None
    )
    state = await run(tiger, around)
    assert OPEN_RIGHT not in {action for action, _ in around.chosen}
    assert state.left_out == {OPEN_RIGHT: "ana"}
    last = around.decisions[-1]
    assert {value.action for value in last.actions} == {"listen", OPEN_LEFT}
    assert last.set_aside == {OPEN_RIGHT: f"{OPEN_RIGHT} is left out by ana"}
    async with engine_of(tiger) as engine:
        whole = await engine.plan(seed=1, simulations=2000)
        less = await engine.plan(
            seed=1, simulations=2000, within=Restriction(without_actions=[_index(engine, OPEN_RIGHT)])
        )
    # A grounded action that is barred now alone could still be used later.
    assert less.best.q < whole.best.q - 1


def _index(engine: Engine, action: str) -> int:
    return [each.name for each in engine.description.actions].index(action)


async def test_a_mission_without_anything_left_holds_until_something_is_taken_back(tiger: BuiltModel):
    around = Steered()

    def leave_all_out(request: Activate):
        if request.id.step == 1:
            around.steer("leave_out", name="listen")
            around.steer("leave_out", name="open")

    around.on_act = leave_all_out
    around.on_hold = in_turn(
        lambda: around.steer("act", "listen"),
        lambda: around.steer("take_back", name="listen"),
        lambda: around.steer("resume"),
    )
    state = await run(tiger, around, step_limit=2)
    assert (state.ending, around.chosen[1]) == ("step_limit", ("listen", "planner"))
    (refused,) = [payload for _, payload in around.journalled if isinstance(payload, ActionRefused)]
    assert refused.why == "listen is left out by ana"
    assert violations(around) == []


async def test_constraints_hold_for_what_an_operator_wants():
    project = bundle_project(BUNDLES / "bench" / "tiger")
    never = "open && state.tiger_behind == Left"
    constraint = constraint_of_option(f"0.1: {never}")
    built = await built_project(constrained(project, [constraint]))
    around = Steered()
    said: list[SteeringError] = []

    async def ask():
        try:
            await around.mission.until_decided(f"act {OPEN_LEFT}  1")
        except SteeringError as error:
            said.append(error)

    waiting: list[asyncio.Task[None]] = []

    def at_first(request: Activate):
        if request.id.step == 1:
            around.steer("act", OPEN_LEFT)
            waiting.append(asyncio.ensure_future(ask()))

    around.on_act = at_first
    await run(built, around, step_limit=2)
    await asyncio.gather(*waiting)
    assert around.chosen[1][1] == "planner"
    assert said[0].code == "AOS518"
    assert f"never {never}: 0.1 is left of 0.1, and it risks 0." in said[0].message


async def test_a_script_ends_at_a_skill_that_fails_and_nothing_is_tried_again(tiger: BuiltModel):
    def breaks_once(request: Activate) -> Outcome:
        return jammed(request) if request.id.step == 2 else hears_left(request)

    around = Steered(breaks_once)
    around.on_act = lambda request: (
        around.steer("script", "listen", OPEN_LEFT) if request.id.step == 1 else None
    )
    seen: list[MissionState] = []
    around.on_hold = in_turn(lambda: (seen.append(around.mission.state), around.steer("resume"))[0])
    rules = FailureRules(skills={"listen": SkillRule(on_failure="retry", retries=3)})
    await run(tiger, around, step_limit=3, rules=rules)
    assert (seen[0].held_by, seen[0].step) == ("the script of ana", 2)
    assert around.chosen[2][1] == "planner"


async def test_stop_ends_a_search_that_would_take_minutes(tiger: BuiltModel):
    around = Steered()
    loop = asyncio.get_running_loop()

    def soon(state: MissionState):
        around.states.append(state)
        if state.phase == "planning" and state.step == 0:
            loop.call_soon(around.steer, "stop")

    around.publish_state = soon
    state = await run(tiger, around, search=Search(simulations=0, time_s=60.0, seed=1))
    assert (state.ending, state.remark, around.decisions) == ("cancelled", "stopped by ana", [])


async def test_a_mission_cut_off_at_any_row_is_steered_as_before(tiger: BuiltModel):
    """Whoever asks goes on asking until the mission has heard it, as a client does."""

    def operated(memory: MissionMemory) -> Steered:
        around = Steered()
        wishes = [("act", OPEN_LEFT), ("step",), ("leave_out",), ("resume",)]

        def wish():
            for number, (verb, *actions) in enumerate(wishes):
                before = len(around.journalled)
                name = OPEN_RIGHT if verb == "leave_out" else ""
                around.mission.steer(Steer(verb, tuple(actions), name, by="ana", request=str(number)))
                if len(around.journalled) > before:
                    return

        around.on_hold = wish
        hold = Steer("hold", by="ana", request="hold")
        around.on_act = lambda request: around.mission.steer(hold) if request.id.step == 1 else None
        return around

    whole = operated(MissionMemory())
    await run(tiger, whole)
    rows = rows_of(whole.journalled)
    assert [by for _, by in whole.chosen] == ["planner", "operator", *["planner"] * 4]
    for cut in range(1, len(rows)):
        before = folded(rows[:cut])
        rest = operated(before)
        state = await run(tiger, rest, memory=before)
        joined = Steered()
        joined.journalled = [*whole.journalled[:cut], *rest.journalled]
        assert violations(joined) == [], cut
        assert (state.ending, state.left_out) == ("step_limit", {OPEN_RIGHT: "ana"}), cut
        twin = folded(rows_of(joined.journalled))
        assert [step.decision.chosen_by for step in twin.steps] == [by for _, by in whole.chosen], cut


async def test_a_mission_that_could_not_reach_its_goal_without_a_skill_holds_and_does_not_give_up():
    built = await built_text(counting("lamp", "press", steps="1", reward=-1))
    around = Steered(lambda request: observed(request, "done"))
    around.on_act = lambda request: around.steer("leave_out", name="press") if request.id.step == 1 else None
    around.on_hold = in_turn(lambda: around.steer("take_back", name="press"))
    state = await run(built, around, step_limit=2)
    assert (state.ending, len(around.decisions)) == ("step_limit", 2)
    assert any(
        each.phase == "holding" and "press is left out by ana" in each.remark for each in around.states
    )
