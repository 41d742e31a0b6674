from collections.abc import AsyncIterator

import pytest
from mappings import mapping_text
from models import engine_of_text
from processes import kill_engine

from aos_solver.child.engine import Engine
from aos_solver.child.process.engine_child import ANSWER_LIMIT_BYTES

LAMPS, CELLS = 17, 40
ENVIRONMENT = f"""project: lamps
horizon: 5
discount: 0.95

state_variable: int unit
code:
state.unit = 3;

state_variable: int code

state_variable: bool lamps []
code:
state.lamps.assign({LAMPS}, false);

state_variable: int cells []
code:
state.cells.assign({CELLS}, -2000000000);

initial_belief:
for (int i = 0; i < {LAMPS}; i++) {{
    state.lamps[i] = AOS.Bernoulli(0.4);
    if (i < 8 && state.lamps[i]) state.code |= 1 << i;
}}
"""
READ = """project: lamps

dynamic_model:
state__.cells[0] = 0;
if (state.unit == 3) __moduleResponse = AOS.Bernoulli(state.lamps[0] ? 0.9 : 0.2) ? yes : no;
state_given_observation:
state___.cells[1] = number;
"""
READ_MAPPING = mapping_text(
    "yes: number > 0", "no: True", project="lamps", skill="read", reports={"number": "int"}
)
FILES = {"lamps.ef": ENVIRONMENT, "read.sd": READ, "read.am": READ_MAPPING}
"""2^17 states, more than a belief holds, of 59 numbers each; the unit is a constant."""

NOW_VARIABLE = FILES | {"read.sd": READ.replace("dynamic_model:\n", "dynamic_model:\nstate__.unit += 1;\n")}
"""Documents with the same variables, of which none is a constant."""


@pytest.fixture
async def engine() -> AsyncIterator[Engine]:
    async with engine_of_text(FILES) as engine:
        yield engine


async def test_a_killed_engine_comes_back_with_a_large_belief(engine: Engine):
    before = (await engine.update("read", "yes")).summary
    for _ in range(2):
        await kill_engine(engine.pid)
        after = await engine.summary()
        assert (after.states, after.error_bound) == (before.states, before.error_bound)
        assert after.entropy == pytest.approx(before.entropy)
        before = (await engine.update("read", "no")).summary


async def test_a_correction_keeps_what_is_known_of_the_error(engine: Engine):
    before = await engine.summary()
    update = await engine.update("read", "yes", {"number": "7"})
    assert update.remark == ""
    assert update.summary.marginals[2 + LAMPS].values == {"7": pytest.approx(1)}
    assert before.error_bound > 0
    assert update.summary.error_bound == pytest.approx(before.error_bound / update.probability)


async def test_a_belief_goes_over_in_pieces_to_documents_with_other_constants(engine: Engine):
    before = (await engine.update("read", "yes")).summary
    belief = await engine.export_belief()
    assert sum(len(state) for _, state in belief.particles) > ANSWER_LIMIT_BYTES
    assert belief.constants == {"unit": "3"}
    async with engine_of_text(NOW_VARIABLE) as other:
        after = await other.import_belief(belief)
        moved = await other.export_belief()
        back = await engine.import_belief(moved)
    units = [marginal.values for marginal in after.marginals if marginal.variable == "unit"]
    assert units == [{"3": pytest.approx(1)}]
    assert (after.states, after.error_bound) == (before.states, before.error_bound)
    assert moved.constants == {}
    assert (back.states, back.error_bound) == (before.states, before.error_bound)


async def test_of_many_values_the_likeliest_are_told_and_the_rest_summed_up(engine: Engine):
    marginals = {marginal.variable: marginal for marginal in (await engine.summary()).marginals}
    codes = marginals["code"]
    assert len(codes.values) == 16
    assert list(codes.values) == sorted(codes.values, key=lambda code: -codes.values[code])
    assert codes.values["0"] == pytest.approx(0.6**8, abs=0.002)
    assert sum(codes.values.values()) + codes.others == pytest.approx(1)
    assert marginals["lamps[16]"].others == 0
