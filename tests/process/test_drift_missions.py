from models import engine_of_text
from scripted_missions import Surroundings, observed
from test_taking_up import rows_of

from aos_deploy.views.lines import decision_line
from aos_protocol.messages import DriftTests
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.records.memory import folded
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms

PRESS = """project: lamp
dynamic_model:
__moduleResponse = AOS.Bernoulli(0.9) ? pressed : stuck;
__reward = -1;
"""
LAMP = {
    "lamp.ef": """project: lamp
horizon: 3
discount: 0.9
state_variable: bool is_on
code:
state.is_on = false;
reward_code:
if (state.is_on) { __reward = 10; __isGoalState = true; }
""",
    "press.sd": PRESS,
}


async def played(
    files: dict[str, str], response: str, drift: DriftTests | None = None
) -> tuple[Mission, Surroundings]:
    around = Surroundings(lambda request: observed(request, response))
    limits = MissionLimits(step_limit=8, goal_probability=2.0)
    terms = Terms(name="m", limits=limits, search=Search(simulations=50, seed=1))
    async with engine_of_text(files) as engine:
        mission = Mission(terms, RunningModel(1, engine), around, drift=drift)
        await mission.run_or_raise()
        return mission, around


async def test_a_skill_that_does_not_do_what_its_document_says_is_told_in_the_records():
    mission, around = await played(LAMP, "stuck")
    alarmed = [record for record in around.outcomes if record.drift]
    assert 2 <= alarmed[0].step <= 6
    assert [record.step for record in alarmed] == [*range(alarmed[0].step, 9)]
    assert [any(alarm.is_new for alarm in record.drift) for record in alarmed].count(True) == 1
    uses = alarmed[0].step
    text = f"the model of press does not hold: pressed in 0.00 of {uses} uses, modelled 0.90"
    assert text in decision_line(alarmed[0])
    assert folded(rows_of(around.journalled)).drift == mission.drift


async def test_the_tests_go_over_to_the_next_mission_and_not_to_other_documents():
    first, _ = await played(LAMP, "pressed")
    second, _ = await played(LAMP, "pressed", first.drift)
    assert [test.uses for test in second.drift.tests] == [16, 16]
    other = LAMP | {"press.sd": PRESS.replace("0.9", "0.8")}
    third, _ = await played(other, "pressed", second.drift)
    assert [test.uses for test in third.drift.tests] == [8, 8]
