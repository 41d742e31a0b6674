from models import built_text
from scripted_missions import Surroundings, observed, run_mission
from wide.writing import BundleWriter

from aos_protocol.messages import MissionState
from aos_solver.child.search import Search
from aos_solver.mission.rules.endings import MissionLimits

_SAID = (
    "changed nothing and told nothing, since nothing is known that is worth more "
    "within the horizon of 4 decisions"
)


def _door(by_itself: str) -> dict[str, str]:
    """A door: going through it earns 5 where it is open and costs 5 elsewhere, and waiting costs nothing."""
    writer = BundleWriter(
        "door",
        f"""horizon: 4
discount: 0.9

state_variable: bool is_open

state_variable: bool is_through

initial_belief:
state.is_open = false;

extrinsic_code:
{by_itself}

reward_code:
if (state.is_through) __isGoalState = true;
""",
    )
    writer.skill(
        "go",
        "__reward = state_.is_open ? 5 : -5;\nstate__.is_through = state_.is_open;\n"
        "__moduleResponse = state_.is_open ? through : hurt;",
    )
    writer.skill("wait", "__moduleResponse = state_.is_open ? open : closed;")
    return writer.files


async def _mission(by_itself: str, limits: MissionLimits) -> tuple[MissionState, Surroundings]:
    built = await built_text(_door(by_itself))
    return await run_mission(
        built,
        lambda request: observed(request, "closed"),
        limits=limits,
        search=Search(simulations=200, seed=1),
    )


async def test_the_step_limit_and_each_record_tell_that_nothing_happened():
    state, around = await _mission("", MissionLimits(step_limit=7))
    assert state.ending == "step_limit"
    assert state.remark == f"the step limit of 7 is reached; the last 7 decisions {_SAID}"
    assert "which changes nothing and tells nothing" in around.decisions[0].why


async def test_a_mission_that_may_stop_for_nothing_gives_up():
    state, _around = await _mission("", MissionLimits(step_limit=9, stop_below_value=0))
    assert (state.ending, state.step) == ("nothing_worthwhile", 4)
    assert state.remark == f"the last 5 decisions {_SAID}"


async def test_who_waits_for_what_happens_by_itself_is_not_idle():
    opens = "if (!state.is_open) state_.is_open = AOS.Bernoulli(0.3);"
    state, around = await _mission(opens, MissionLimits(step_limit=7, stop_below_value=0))
    assert state.ending == "step_limit"
    assert "changes nothing" not in around.decisions[0].why


async def test_nothing_is_begun_that_the_step_limit_does_not_let_end():
    writer = BundleWriter(
        "mine",
        "horizon: 4\ndiscount: 0.9\n\nstate_variable: int depth\n\ninitial_belief:\nstate.depth = 0;\n",
    )
    writer.skill(
        "dig",
        "state__.depth = state_.depth == 2 ? 0 : state_.depth + 1;\n__reward = state_.depth == 2 ? 9 : -1;",
    )
    writer.skill("gather", "__reward = 1;")
    built = await built_text(writer.files)
    _, around = await run_mission(
        built,
        lambda request: observed(request, "DefaultObservation"),
        limits=MissionLimits(step_limit=5),
        search=Search(simulations=200, seed=1, step_limit=5, plans_to_step_limit=True),
    )
    assert [each.action for each in around.decisions] == ["dig"] * 3 + ["gather"] * 2
    assert [each.horizon for each in around.decisions] == [4, 4, 3, 2, 1]


async def test_nobody_waits_for_a_state_that_is_never_seen():
    writer = BundleWriter(
        "doors",
        """horizon: 20
discount: 0.95

state_variable: int door

state_variable: bool is_over

initial_belief:
state.door = AOS.SampleDiscrete(std::vector<double>(8, 1.0));

reward_code:
if (state.is_over) __isGoalState = true;
""",
    )
    writer.skill(
        "open", "state__.is_over = true;\n__reward = state.door == door ? 10 : -50;", over={"door": "8"}
    )
    writer.skill("leave", "state__.is_over = true;")
    writer.skill("wait", "__reward = -0.2;")
    built = await built_text(writer.files)
    _, around = await run_mission(
        built,
        lambda request: observed(request, "DefaultObservation"),
        limits=MissionLimits(step_limit=1),
        search=Search(simulations=500, seed=1, planner="pomcp"),
    )
    assert [each.action for each in around.decisions] == ["leave"]
