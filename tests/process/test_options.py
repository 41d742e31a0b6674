from models import built_text, engine_of, engine_of_text, simulated
from wide.gauges import gauges
from wide.leaving import survey
from wide.lock import lock
from wide.problems import parcels
from wide.towers import towers
from wide.writing import BundleWriter

from aos_solver.child.engine import Restriction


async def test_many_things_are_tested_before_they_are_sent_off():
    """Parcels sent where most of them belong lose 1.0 each, so that 14 of them lose 6 in all."""
    built = await built_text(parcels(14))
    async with engine_of(built) as engine, engine_of(built) as other:
        plan = await engine.plan(simulations=1000, seed=1, planner="auto")
        assert plan.planner == "options"
        assert plan.actions[plan.index].action.startswith(("scan", "open"))
        assert (await other.plan(simulations=1000, seed=1, planner="auto")).actions == plan.actions
        # An action that is barred is not taken.
        within = Restriction(barred=[plan.index])
        barred = await other.plan(simulations=1000, seed=1, planner="auto", within=within)
        assert (barred.planner, barred.index == plan.index) == ("options", False)
        run = await simulated(engine, 1000, goal_probability=1, step_limit=80)
    assert run.discounted_return > 10


async def test_a_budget_in_time_ends_a_decision_of_options_after_a_first_look_that_is_long_enough():
    """A mission is prepared by what its first look finds. No machine's load counts in processor time.

    For 40 parcels a fast processor has tried everything in that time.
    """
    built = await built_text(parcels(80))
    async with engine_of(built) as engine, engine_of(built) as other:
        for child in (engine, other):
            await child.count_processor_time(True)
        hurried = await engine.plan(simulations=1, time_s=1e-6, seed=1)
        unhurried = await other.plan(simulations=1, time_s=3, seed=1)
    assert (hurried.planner, unhurried.planner) == ("options", "options")
    assert 100 < hurried.simulations < unhurried.simulations


async def test_a_mission_of_one_decision_is_told_the_mean_reward_of_each_action():
    """Nothing follows a look, and what is seen by it is worth nothing."""
    writer = BundleWriter(
        "reach",
        """horizon: 1
discount: 0.95

state_variable: double x

initial_belief:
state.x = AOS.SampleUniform(0, 4);
""",
    )
    look = "__reward = -0.1;\n__moduleResponse = state.x < 1 ? left : right;"
    writer.skill("look", look)
    reach = "__reward = state.x < 1 + where ? 10 - 3.5 * where : -2;\n__moduleResponse = done;"
    writer.skill("reach", reach, over={"where": "3"})
    async with engine_of_text(writer.files) as engine:
        plan = await engine.plan(simulations=2000, seed=1, planner="auto")
    told = {value.action: value for value in plan.actions}
    assert abs(told["look"].q + 0.1) < 1e-9
    for where, mean in enumerate((1.0, 2.25, 1.75)):
        value = told[f"reach(where={where})"]
        assert abs(value.q - mean) < 3 * value.stderr
    assert plan.best.action == "reach(where=1)"


async def test_a_reward_that_asks_for_many_conditions_at_once_is_found():
    """A lock opens when five dials are right, and nothing is earned before. Random actions return -24."""
    async with engine_of_text(lock(5)) as engine:
        run = await simulated(engine, 2000, goal_probability=1, step_limit=80)
    assert run.actions[-1] == "pull"
    assert run.discounted_return > 5


async def test_a_robot_leaves_where_promises_are_not_kept():
    """Twelve sites are hardly worth a probe. Without the rule the robot probes and drives for ever."""
    async with engine_of_text(survey(12)) as engine:
        run = await simulated(engine, 1000, goal_probability=1, step_limit=60)
    assert run.actions[-1] == "leave"
    assert run.discounted_return > -9


async def test_a_camera_is_wiped_where_the_robot_goes_before_it_reads():
    """A robot without detours reads what it knows, up to the last step, since nothing else costs less."""
    async with engine_of_text(gauges(8)) as engine:
        run = await simulated(engine, 10000, seed=302, goal_probability=1, step_limit=60)
    assert "wipe" in run.actions
    assert run.actions[-1].startswith("report")
    assert len(run.actions) < 60


async def test_blocks_in_each_others_way_are_taken_down_though_grips_slip():
    """A rule by hand returns 69, and whoever waits for 60 steps -18."""
    async with engine_of_text(towers(8)) as engine:
        run = await simulated(engine, 2000, goal_probability=1, step_limit=60)
    assert run.discounted_return > 50


async def test_an_end_that_pays_hides_no_way_to_more():
    """Each of four letters pays 7 at its place. To park pays 2 at once, and a search for ways stops there."""
    mail = BundleWriter(
        "mail",
        """horizon: 40
discount: 0.98
state_variable: int at
state_variable: double charge
state_variable: bool given []
code:
state.given.assign(5, false);
state_variable: bool has_parked
initial_belief:
state.charge = AOS.SampleUniform(40, 60);
reward_code:
if (state.has_parked) __isGoalState = true;
""",
    )
    drive = "__reward = -0.4;\nstate__.at = to;\nstate__.charge -= AOS.SampleUniform(0.5, 2);\n"
    mail.skill("drive", drive + "__moduleResponse = there;", over={"to": "5"})
    give = "__reward = state.at > 0 && !state.given[state.at] && state.charge > 0 ? 7 : -2;\n"
    mail.skill("give", give + "state__.given[state.at] = true;\n__moduleResponse = given;")
    mail.skill("park", "__reward = 2;\nstate__.has_parked = true;\n__moduleResponse = parked;")
    async with engine_of_text(mail.files) as engine:
        plan = await engine.plan(simulations=1000, seed=1, planner="auto")
        run = await simulated(engine, 1000, goal_probability=1, step_limit=30)
    assert plan.planner == "options"
    assert run.discounted_return > 20
    assert run.actions[-1] == "park"


async def test_a_robot_whose_battery_ends_is_not_led_by_what_intruders_pay():
    """Intruders come by themselves, and cost more than they pay. No way leads through the dock."""
    patrol = BundleWriter(
        "patrol",
        """horizon: 50
discount: 0.96
state_variable: int at
state_variable: int battery
default_value: 24
state_variable: bool intruder []
code:
state.intruder.assign(10, false);
initial_belief:
for (int i = 1; i < 10; i++) state.intruder[i] = AOS.Bernoulli(0.1);
extrinsic_code:
for (int i = 1; i < 10; i++) if (!state.intruder[i] && AOS.Bernoulli(0.03)) state_.intruder[i] = true;
reward_code:
__isFailureState = state.battery < 0;
__reward = state.battery < 0 ? -40 : 0;
reward_code:
for (int i = 1; i < 10; i++) __reward -= state.intruder[i] ? 0.3 : 0;
""",
    )
    go = "state__.battery--;\n__reward = -0.1;\nstate__.at = (state.at + (east ? 1 : 9)) % 10;\n"
    patrol.skill("go", go + "__moduleResponse = moved;", over={"east": "2"})
    look = "__reward = -0.1;\nbool is_seen = AOS.Bernoulli(state_.intruder[state.at] ? 0.9 : 0.1);\n"
    patrol.skill("look", look + "state__.battery--;\n__moduleResponse = is_seen ? somebody : nobody;")
    expel = "state__.battery -= 2;\n__reward = state_.intruder[state.at] ? 4 : -3;\n"
    patrol.skill("expel", expel + "state__.intruder[state.at] = false;\n__moduleResponse = done;")
    charge = "__reward = state.at == 0 ? -0.1 : -0.5;\nif (state.at == 0) state__.battery = 24;\n"
    patrol.skill("charge", charge + "__moduleResponse = charged;")
    async with engine_of_text(patrol.files) as engine:
        run = await simulated(engine, 1000, goal_probability=1, step_limit=30)
        plan = await engine.plan(simulations=100, seed=1, planner="auto")
    assert "what is neglected costs more than ways to rewards earn" in plan.why
    assert len(run.actions) == 30, "longer than a battery lasts"
    assert "charge" in run.actions


async def test_a_robot_does_not_go_on_going_where_it_is_already():
    """A way into a room promises nothing more where the robot is in it."""
    coats = BundleWriter(
        "coats",
        """horizon: 60
discount: 0.98
state_variable: int room
state_variable: bool worn []
code:
state.worn.assign(9, false);
state_variable: bool sold []
code:
state.sold.assign(9, false);
initial_belief:
for (int i = 0; i < 9; i++) state.worn[i] = AOS.Bernoulli(0.45);
""",
    )
    go = "__reward = -1;\nif (AOS.Bernoulli(0.9)) state__.room = to;\n"
    coats.skill("go", go + "__moduleResponse = state__.room == to ? there : not_there;", over={"to": "3"})
    here = "bool is_here = state.room == coat / 3;\n"
    feel = here + "__reward = -0.3;\nbool is_rough = AOS.Bernoulli(0.75) == state.worn[coat];\n"
    feel += "__moduleResponse = !is_here ? nothing : is_rough ? rough : smooth;"
    coats.skill("feel", feel, over={"coat": "9"})
    sell = here + "__reward = !is_here || state.sold[coat] ? -1 : state.worn[coat] ? -5 : 4;\n"
    sell += "if (is_here) state__.sold[coat] = true;\n__moduleResponse = sold;"
    coats.skill("sell", sell, over={"coat": "9"})
    async with engine_of_text(coats.files) as engine:
        run = await simulated(engine, 1000, seed=2, goal_probability=1, step_limit=40)
    assert sum(action.startswith("go") for action in run.actions) <= 6
    assert sum(action.startswith("sell") for action in run.actions) >= 4
