import pytest
from commands import aos
from models import engine_of_text
from texts import write_texts
from wide.missions import processor_s
from wide.shelf import shelf
from wide.writing import BundleWriter

from aos_protocol.errors import IntractableError
from aos_solver.child.answers.models import Plan


def _cliff(far: str) -> dict[str, str]:
    """One action earns 2 and fails in one of a thousand, the other earns 1."""
    writer = BundleWriter(
        "cliff",
        """horizon: 1
discount: 0.9

state_variable: bool fell

initial_belief:
state.fell = false;

reward_code:
if (state.fell) {
    __reward = -5000;
    __isFailureState = true;
}
""",
    )
    dare = f"__reward = 2;\n{far}\nstate__.fell = drawn > 3.0902;\n__moduleResponse = done;"
    writer.skill("dare", dare)
    writer.skill("rest", "__reward = 1;\n__moduleResponse = done;")
    return writer.files


async def _plan(files: dict[str, str], planner: str = "auto") -> Plan:
    async with engine_of_text(files) as engine:
        return await engine.plan(simulations=5000, seed=1, planner=planner)


async def test_values_are_those_of_the_same_model_with_flags():
    files = shelf()
    plan = await _plan(files)
    assert plan.planner == "sarsop"
    assert plan.why.startswith("all 57 states can be listed, and each continuous draw stands for 240")
    twin = files | {
        "go.sd": files["go.sd"].replace("AOS.SampleNormal(0, 1) > 1.0", "AOS.Bernoulli(0.1586553)"),
        "grab.sd": files["grab.sd"].replace("AOS.SampleUniform(0, 1) < 0.8", "AOS.Bernoulli(0.8)"),
    }
    async with engine_of_text(twin) as engine:
        exact = await engine.exact_values(horizon=10)
    best = max(value.q for value in exact.actions)
    assert plan.best.q == pytest.approx(best, abs=0.05)
    assert 0 < plan.best.stderr < 1


@pytest.mark.parametrize("planner", ["auto", "pomcp", "despot", "sarsop"])
async def test_no_planner_tells_bounds_of_it(planner):
    plan = await _plan(shelf(), planner)
    assert all(action.at_least is None and action.at_most is None for action in plan.actions)
    assert "proven" not in plan.why


def test_asked_for_exactly_the_command_says_why_not_and_what_to_do(tmp_path):
    write_texts(shelf(), tmp_path)
    error = aos("plan", tmp_path, "--exact").exception
    assert isinstance(error, IntractableError)
    assert error.message == "the values cannot be enumerated: a draw is continuous"
    assert error.hint == "Leave out --exact to search for them"


async def test_a_rare_draw_counts():
    plan = await _plan(_cliff("double drawn = AOS.SampleNormal(0, 1);"))
    assert plan.actions[plan.index].action == "rest"


async def test_two_draws_have_fewer_strata_and_a_state_that_keeps_its_draw_none():
    two = "double drawn = 0.7071 * (AOS.SampleNormal(0, 1) + AOS.SampleNormal(0, 1));"
    assert "stands for 60 numbers" in (await _plan(_cliff(two))).why
    files = shelf()
    kept = files | {
        "e.ef": files["e.ef"].replace("state_variable: int at\n", "state_variable: double at\n"),
        "go.sd": files["go.sd"].replace("= shelf;", "= 0.9 * state.at + AOS.SampleNormal(shelf, 0.1);"),
        "look.sd": files["look.sd"].replace("state.at == state.box", "fabs(state.at - state.box) < 0.5"),
    }
    assert (await _plan(kept)).planner in {"options", "pomcp"}


async def test_an_engine_spends_the_processor_time_of_the_process_below_its_guard():
    async with engine_of_text(shelf()) as engine:
        before = processor_s(engine)
        plan = await engine.plan(simulations=5000, seed=1, planner="pomcp")
        assert processor_s(engine) - before > plan.search_s / 100
