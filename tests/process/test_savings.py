from models import built_text, engine_of, engine_of_text, simulated
from wide.cleaning import cleaning
from wide.greenhouse import greenhouse
from wide.writing import BundleWriter

from aos_solver.child.engine import Restriction

_SIMULATIONS = 500


async def test_plants_are_watered_the_tank_is_refilled_and_a_value_is_what_missions_return():
    """Over 60 steps rests return -82 on average, and a round trip by hand -17."""
    built = await built_text(greenhouse(5))
    async with engine_of(built) as engine, engine_of(built) as other:
        plan = await engine.plan(simulations=_SIMULATIONS, seed=1, planner="auto")
        assert plan.planner == "savings"
        same = await other.plan(simulations=_SIMULATIONS, seed=1, planner="auto")
        assert same.actions == plan.actions
        # An action that is barred saves nothing.
        within = Restriction(barred=[plan.index])
        barred = await other.plan(simulations=_SIMULATIONS, seed=1, planner="auto", within=within)
        assert (barred.planner, barred.index == plan.index) == ("savings", False)
        run = await simulated(engine, _SIMULATIONS, goal_probability=1, step_limit=60)
    assert sum(action.startswith("water") for action in run.actions) >= 12
    assert sum(action == "refill" for action in run.actions) >= 2
    told = plan.actions[plan.index]
    assert run.discounted_return > -30
    assert abs(told.q - run.discounted_return) < 3 * told.stderr


async def test_a_robot_charges_and_empties_its_bin_although_that_saves_nothing_at_once():
    async with engine_of_text(cleaning(7)) as engine:
        run = await simulated(engine, _SIMULATIONS, goal_probability=1, step_limit=15)
    assert sum(action == "clean" for action in run.actions) >= 4
    assert {"charge", "empty_bin"} <= set(run.actions)


def _pumps() -> dict[str, str]:
    """Pumps clog, and two mechanics who are sent for come later: what an order is worth shows only then."""
    writer = BundleWriter(
        "pumps",
        """horizon: 70
discount: 0.98

state_variable: int clogged []
code:
state.clogged.assign(9, 0);

state_variable: int site []
code:
state.site.assign(2, -1);

initial_belief:
for (int i = 0; i < 9; i++) state.clogged[i] = AOS.SampleDiscrete({0.4, 0.3, 0.2, 0.1});

extrinsic_code:
for (int i = 0; i < 9; i++) {
    bool clogs = AOS.Bernoulli(i % 2 == 0 ? 0.09 : 0.03);
    if (clogs && state.clogged[i] < 5) state_.clogged[i] = state.clogged[i] + 1;
}
for (int who = 0; who < 2; who++) {
    if (state.site[who] < 0 || !AOS.Bernoulli(who == 0 ? 0.3 : 0.15)) continue;
    state_.clogged[state.site[who]] = 0;
    state_.site[who] = -1;
}

reward_code:
int flow = 45;
for (int i = 0; i < 9; i++) flow -= state.clogged[i];
__reward = -0.2 * std::max(34 - flow, 0);
""",
    )
    order = """bool is_free = state.site[who] < 0;
__reward = (who == 0 ? -1 : -0.4) - (is_free ? 0 : 1);
if (is_free) state__.site[who] = pump;
__moduleResponse = is_free ? went : busy;"""
    writer.skill("order", order, over={"who": "2", "pump": "9"})
    gauge = """__reward = -0.1;
bool seems_clogged = AOS.Bernoulli(0.85) == (state__.clogged[pump] > 1);
__moduleResponse = seems_clogged ? clogged : clear;"""
    writer.skill("gauge", gauge, over={"pump": "9"})
    writer.skill("wait", "__moduleResponse = waited;")
    return writer.files


async def test_an_order_counts_by_what_comes_of_it_later_and_rollouts_decide_where_they_tell_more():
    """Over 50 steps rests return -65 on average; without rests after a way this mission returns -69.6."""
    built = await built_text(_pumps())
    async with engine_of(built) as engine, engine_of(built) as other:
        run = await simulated(engine, _SIMULATIONS, seed=2, goal_probability=1, step_limit=50)
        plan = await other.plan(simulations=_SIMULATIONS, seed=3, planner="auto")
    assert run.discounted_return > -55
    assert (plan.planner, "more by rollouts" in plan.why) == ("pomcp", True)
