from models import engine_of_text

BOXES = """project: boxes
horizon: 20
discount: 0.95

state_variable: bool full []
code:
state.full.assign(24, false);

state_variable: int end

initial_belief:
for (int i = 0; i < 24; i++) state.full[i] = AOS.Bernoulli(0.4);

reward_code:
if (state.end == 1) { __reward = 0; __isGoalState = true; }
if (state.end == 2) { __reward = -100; __isFailureState = true; }
"""

RARE_LOSS = {
    "rare.ef": BOXES,
    "open.sd": """project: boxes
parameter: int box
parameter: bool carefully

available_parameters_code:
for (int i = 0; i < 24; i++) {
    __possibleParameters.push_back(std::make_tuple(i, false));
    __possibleParameters.push_back(std::make_tuple(i, true));
}

dynamic_model:
__moduleResponseStr = state.full[box] ? "coin" : "nothing";
__reward = state.full[box] ? 3 : 0;
state__.full[box] = false;
if (carefully) __reward -= 0.5;
else if (AOS.Bernoulli(0.0001)) __reward -= 100000;
""",
}
"""Care costs 0.5. Without it a box costs 10 on average: once in 10,000 times 100,000."""

BOMBS = {
    "bombs.ef": BOXES,
    "open.sd": """project: boxes
parameter: int box

available_parameters_code:
for (int i = 0; i < 24; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
__moduleResponseStr = state.full[box] ? "bomb" : "nothing";
if (state.full[box]) state__.end = 2;
""",
    "wait.sd": """project: boxes

dynamic_model:
__reward = -0.1;
__moduleResponseStr = "nothing";
""",
    "leave.sd": """project: boxes

dynamic_model:
state__.end = 1;
__moduleResponseStr = "left";
""",
}
"""Boxes hold nothing but bombs, so that it is best to leave. Who waits pays 0.1 for each step."""

ALARMS = {
    "alarms.ef": """project: alarms
horizon: 20
discount: 0.95

state_variable: bool up []
code:
state.up.assign(30, true);

initial_belief:
for (int i = 0; i < 30; i++) state.up[i] = AOS.Bernoulli(0.8);

extrinsic_code:
for (int i = 0; i < 30; i++)
    if (state.up[i]) state_.up[i] = AOS.Bernoulli(state.up[(i + 1) % 30] ? 0.98 : 0.85);
""",
    "restart.sd": """project: alarms
parameter: int machine

available_parameters_code:
for (int i = 0; i < 30; i++) __possibleParameters.push_back(std::make_tuple(i));

dynamic_model:
state__.up[machine] = true;
vector<double> odds;
double sum = 0;
for (int i = 0; i < 30; i++) {
    odds.push_back(state__.up[i] ? 0.02 : 1);
    sum += odds[i];
}
for (double& each : odds) each /= sum;
__moduleResponseStr = "alarm " + std::to_string(AOSUtils::SampleDiscrete(odds));
""",
}
"""Machines in a ring fail beside one that is down. Each step has an alarm, as a rule of one that is down."""


async def first_actions(files: dict[str, str], simulations: int) -> list[str]:
    async with engine_of_text(files) as engine:
        plans = [await engine.plan(simulations=simulations, seed=seed, planner="auto") for seed in (1, 2, 3)]
    return [plan.best.action for plan in plans]


async def test_a_rare_loss_counts_in_full_though_no_simulation_may_meet_it():
    for action in await first_actions(RARE_LOSS, 2000):
        assert "carefully=true" in action


async def test_an_exit_of_certain_worth_is_taken_though_few_simulations_try_it():
    assert await first_actions(BOMBS, 20_000) == ["leave"] * 3


async def test_one_draw_of_many_outcomes_leaves_many_effective_states():
    async with engine_of_text(ALARMS) as engine:
        await engine.reset_world(1)
        effective = []
        for step in range(12):
            outcome = await engine.step_world(step)
            update = await engine.update(engine.description.actions[step].name, outcome.response)
            effective.append(update.summary.effective_states)
    assert min(effective) > 500, effective
