import pytest
from large_bundles import long_array, many_variables
from models import engine_of_text
from texts import encoded

from aos_language.load import load_files
from aos_protocol.messages import BeliefSummary

ELEMENTS = 10_000
VARIABLES = 1_000


def marginal(belief: BeliefSummary, name: str) -> dict[str, float]:
    return next(marginal.values for marginal in belief.marginals if marginal.variable == name)


@pytest.mark.parametrize("files", [many_variables(VARIABLES), long_array(ELEMENTS)], ids=["many", "long"])
def test_nothing_is_wrong_with_a_large_bundle(files):
    found = load_files(encoded(files)).diagnostics
    assert {finding.code for finding in found} <= {"AOS139"}  # There is no goal.


async def test_a_thousand_variables_are_believed_one_by_one():
    async with engine_of_text(many_variables(VARIABLES)) as engine:
        belief = (await engine.update("act(at=2)", "one")).summary
        again = (await engine.update("act(at=1)", "one")).summary
        exported = await engine.export_belief()
        taken_over = await engine.import_belief(exported)
    assert marginal(belief, "v0") == {"1": pytest.approx(0.9), "2": pytest.approx(0.1)}
    assert marginal(again, "v0") == {"1": pytest.approx(81 / 82), "2": pytest.approx(1 / 82)}
    assert [marginal(again, name) for name in ("v1", "v2", "v3", "v4", "v999")] == [
        {"true": 1.0}, {"0.5": 1.0}, {"Low": 1.0}, {"": 1.0}, {"Low": 1.0},
    ]  # fmt: skip
    assert len(again.marginals) == VARIABLES
    assert taken_over == again


async def test_a_long_array_is_believed_element_by_element():
    async with engine_of_text(long_array(ELEMENTS, drawn=5)) as engine:
        belief = (await engine.update("act(at=1)", "one")).summary
        plan = await engine.plan(simulations=50, seed=1, planner="pomcp")
    assert belief.states == 32
    assert belief.is_exact
    assert marginal(belief, "grid[0]") == {"1": pytest.approx(0.9)}
    assert marginal(belief, "grid[4]")[next(iter(marginal(belief, "grid[4]")))] == pytest.approx(0.5)
    assert marginal(belief, f"grid[{ELEMENTS // 2 + 1}]") == {"1": pytest.approx(1.0)}
    assert marginal(belief, f"grid[{ELEMENTS - 1}]") == {"0": pytest.approx(1.0)}
    assert len(belief.marginals) == ELEMENTS
    assert len(plan.actions) == 3
