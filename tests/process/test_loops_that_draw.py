import pytest
from models import engine_of_text

from aos_protocol.errors import ModelError
from aos_solver.child.search import Search
from aos_solver.mission.decision.choices import Choice
from aos_solver.mission.decision.choosing import Chooser
from aos_solver.mission.decision.risk import RiskBudget
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import QuietPorts
from aos_solver.mission.rules.failures import Failures
from aos_solver.mission.rules.terms import Terms

ENVIRONMENT = """project: loops
horizon: 5
discount: 0.95

state_variable: int rounds

initial_belief:
while (true) {
    int across = AOS.Bernoulli(0.5), up = AOS.Bernoulli(0.5);
    if (across && up) continue;
    state.rounds = across + up;
    break;
}
"""
CONTINUOUS = """project: loops

dynamic_model:
int rounds = 0;
while (AOS.SampleUniform(0, 1) > 0.4) rounds++;
state__.rounds = rounds;
__moduleResponse = rounds == 0 ? yes : no;
"""
MANY_WEIGHTS = """project: loops

dynamic_model:
state__.rounds = AOS.SampleDiscrete(vector<double>(2000, 1.0 / 2000));
__moduleResponse = state__.rounds < 500 ? yes : no;
"""
ENDLESS = """project: loops

dynamic_model:
state__.rounds = 1;
while (true) {
    if (AOS.SampleUniform(0, 1) > 2) break;
}
__moduleResponse = yes;
"""


async def test_a_loop_that_draws_numbers_is_sampled_and_many_weights_are_enumerated():
    files = {"loops.ef": ENVIRONMENT, "turn.sd": CONTINUOUS, "weights.sd": MANY_WEIGHTS}
    async with engine_of_text(files) as engine:
        start = await engine.summary()
        assert start.marginals[0].values == {"1": pytest.approx(2 / 3), "0": pytest.approx(1 / 3)}
        assert start.error_bound == 0
        stays = {each.response: each.probability for each in (await engine.predict(0)).predicted}
        assert stays["yes"] == pytest.approx(0.4, abs=0.03)
        rounds = (await engine.update("turn", "no")).summary.marginals[0].values
        assert "0" not in rounds
        assert rounds["1"] == pytest.approx(0.4, abs=0.03)
        await engine.reset_belief()
        update = await engine.update("weights", "yes")
        assert update.probability == pytest.approx(0.25)
        assert update.summary.states == 500


SLOTS = """project: slots
horizon: 4
discount: 0.5

state_variable: bool is_full [Slot]
default_value: false

state_variable: int carried
default_value: 1

define_type: Slot
enum_members: Left, Right

initial_belief:
state.is_full[Left] = AOS.Bernoulli(0.75);
state.is_full[Right] = AOS.Bernoulli(0.5);

reward_code:
if (state.carried == 0) { __reward = 10; __isGoalState = true; }
"""
PLACE = """project: slots

precondition:
__meetPrecondition = !state.is_full[Left];
violate_penalty: -4

dynamic_model:
__reward = -1;
while (true) {
    Slot slot = AOS.SampleDiscrete(Slot, {0.5, 0.5});
    if (!state.is_full[slot]) { state__.is_full[slot] = true; break; }
}
state__.carried = 0;
__moduleResponse = placed;
"""
HOLD = """project: slots

dynamic_model:
bool is_held = false;
while (!is_held) is_held = AOS.Bernoulli(0.5);
__reward = -20;
__moduleResponse = held;
"""


async def test_a_step_that_never_ends_is_a_failure_that_nobody_observes():
    files = {"slots.ef": SLOTS, "place.sd": PLACE}
    async with engine_of_text(files) as engine:
        # The reward before the loop is not earned.
        values = await engine.exact_values(horizon=1)
        assert values.values[0].q == pytest.approx(0.25 * 9 + 0.375 * 5 - 0.375 * 4)
        prediction = await engine.predict(0)
        odds = {predicted.response: predicted.probability for predicted in prediction.predicted}
        assert odds == {"placed": pytest.approx(0.625), "(never ends)": pytest.approx(0.375)}
        update = await engine.update("place", "placed")
        assert update.probability == pytest.approx(0.625)
        assert update.summary.error_bound == 0
        (loop,) = (await engine.endless_steps()).loops
        assert "state.is_full[Left]=true, state.is_full[Right]=true" in loop.state


async def test_a_loop_that_ends_is_not_told_beside_an_endless_one_after_it():
    turned = "dynamic_model:\nint turns = 0;\nwhile (turns < 2) turns += AOS.Bernoulli(0.5);\n"
    files = {"slots.ef": SLOTS, "place.sd": PLACE.replace("dynamic_model:\n", turned)}
    async with engine_of_text(files) as engine:
        prediction = await engine.predict(0)
        odds = {predicted.response: predicted.probability for predicted in prediction.predicted}
        assert odds == {"placed": pytest.approx(0.625), "(never ends)": pytest.approx(0.375)}
        ((_, place),) = await engine.endless_loops()
    lines = files["place.sd"].splitlines()
    assert (place.file, lines[place.line - 1]) == ("place.sd", "while (true) {")


async def test_a_mission_tells_a_loop_without_an_end_in_the_record_of_one_decision():
    files = {"slots.ef": SLOTS, "hold.sd": HOLD, "place.sd": PLACE}
    async with engine_of_text(files) as engine:
        chooser = Chooser(
            Terms(name="m", search=Search(simulations=100, seed=1)), Failures(), QuietPorts(), RiskBudget(())
        )
        model, belief = RunningModel(1, engine), await engine.summary()
        choices = [await chooser.choose(model, step, belief) for step in (1, 2)]
    whys = [choice.plan.why for choice in choices if isinstance(choice, Choice)]
    assert [why.count("place.sd:9:1: this loop never ends in") for why in whys] == [1, 0]


async def test_a_loop_that_draws_without_an_end_is_told_at_its_line():
    files = {"loops.ef": ENVIRONMENT, "turn.sd": ENDLESS}
    with pytest.raises(ModelError) as raised:
        async with engine_of_text(files) as engine:
            await engine.update("turn", "yes")
    assert raised.value.code == "AOS211"
    (diagnostic,) = raised.value.diagnostics
    assert "come to an end" in diagnostic.message
    # Of the loop or of its body, whichever ran.
    assert (diagnostic.span.file, diagnostic.span.line) in (("turn.sd", 5), ("turn.sd", 6))
