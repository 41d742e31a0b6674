import msgspec
import pytest
from hall import HALL, marginal, with_peek
from mapping_documents import skill_of
from models import built_text, engine_of_text
from scripted_missions import Surroundings, jammed, observed, run_mission

from aos_deploy.views.lines import adopted_line
from aos_protocol.errors import PlanningError
from aos_protocol.messages import Activate, ModelAdopted, Outcome
from aos_runtime.clock import SystemClock
from aos_runtime.disk.journal import JournalRow
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine, Restriction
from aos_solver.child.questions.missions import UNRESTRICTED
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.past import Past
from aos_solver.mission.models.takeover import RunningModel, Successor, Takeover
from aos_solver.mission.records.memory import folded
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.terms import Terms


def hears_below(request: Activate) -> Outcome:
    return observed(request, "below")


class Plugged(Surroundings):
    """Surroundings in which a model is ready from some moment on."""

    successor: Successor | None = None

    async def newest_model(self, running: RunningModel, past: Past) -> Takeover | None:
        successor, self.successor = self.successor, None
        return None if successor is None else await successor.take_over(running, past)


async def test_a_skill_that_is_pushed_while_the_mission_holds_ends_the_hold():
    around = Plugged(hears_below)
    around.unavailable = {"look": "the camera is away"}
    async with engine_of_text(with_peek(HALL)) as engine:

        def push():
            around.successor = Successor(RunningModel(2, engine), SystemClock())

        around.on_hold = push
        limits = MissionLimits(step_limit=1)
        state, _ = await run_mission(await built_text(HALL), hears_below, limits=limits, around=around)
    (decision,) = around.decisions
    assert (state.ending, decision.skill, decision.revision) == ("step_limit", "peek", 2)
    assert decision.adopted is not None
    assert (decision.adopted.by, decision.adopted.before) == ("import", 1)
    assert [payload for kind, payload in around.journalled if kind == "adopted"] == [decision.adopted]
    assert (around.outcomes[0].adopted, adopted_line(decision.adopted)) == (
        None,
        "revision 2 takes over from 1, its belief by import",
    )


@pytest.mark.parametrize(("renewed", "looks"), [("peek.am", 3), ("look.am", 6)])
async def test_a_skill_that_is_set_aside_is_used_again_with_other_documents_of_its_own(renewed, looks):
    look = f"{HALL['look.sd']}__reward = "
    files = HALL | {"look.sd": f"{look}2;\n", "peek.sd": f"{look}1;\n"}
    mapping = "project: hall\nresponse: above\nresponse_rule: True\nmodule_activation: skill\npath: /look\n"

    def jams(request: Activate) -> Outcome:
        if request.id.step == 6:
            mended = RunningModel(2, engine, (skill_of(mapping, renewed),))
            around.successor = Successor(mended, SystemClock())
        return jammed(request) if request.skill == "look" else observed(request, "above")

    around = Plugged(jams)
    async with engine_of_text(files) as engine:
        limits = MissionLimits(step_limit=12)
        await run_mission(await built_text(files), jams, limits=limits, around=around)
    assert [record.skill for record in around.decisions].count("look") == looks


class Prepared(Search, frozen=True, kw_only=True):
    """Decides for the first documents alone, as a policy file does."""

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        if not engine.has_action("look"):
            raise PlanningError("solved for other documents", code="AOS322")
        return await Search(simulations=100, seed=1).run(engine, step, within)

    def after_takeover(self) -> Search:
        return Search(simulations=100, seed=1)


async def test_what_was_prepared_for_the_documents_before_is_not_followed_any_more():
    around = Plugged(hears_below)
    terms = Terms(name="m", search=Prepared(simulations=1, seed=1), limits=MissionLimits(step_limit=1))
    async with engine_of_text(HALL) as before, engine_of_text(with_peek(HALL)) as after:
        around.successor = Successor(RunningModel(2, after), SystemClock())
        state = await Mission(terms, RunningModel(1, before), around).run()
    assert (state.ending, state.remark) == ("step_limit", "the step limit of 1 is reached")
    assert [record.skill for record in around.decisions] == ["peek"]


async def test_a_mission_is_taken_up_by_documents_without_the_skill_that_was_decided():
    around = Surroundings(hears_below)
    limits = MissionLimits(step_limit=2)
    await run_mission(await built_text(HALL), hears_below, limits=limits, around=around)
    kinds = [kind for kind, _ in around.journalled]
    second = [number for number, kind in enumerate(kinds) if kind == "decision"][2]
    memory = folded(
        JournalRow(number, number, kind, msgspec.json.encode(payload))
        for number, (kind, payload) in enumerate(around.journalled[: second + 1], start=1)
    )
    assert memory.pending is not None
    rest = Surroundings(hears_below)
    terms = Terms(name="m", search=Search(simulations=100, seed=1), limits=limits)
    async with engine_of_text(with_peek(HALL)) as engine:
        state = await Mission(terms, RunningModel(2, engine), rest, memory).run()
    assert (state.ending, state.step) == ("step_limit", 2)
    assert [record.skill for record in rest.decisions] == ["peek"]
    # The first step counted for nothing but its time.
    assert marginal(rest.decisions[0].belief.marginals, "cat")["Attic"] == pytest.approx(0.25)
    assert marginal(rest.decisions[0].belief.marginals, "is_wet")["true"] == pytest.approx(0.1)


def test_a_takeover_is_told_in_one_line():
    row = ModelAdopted(3, "d", 2, "replay", 12, 1, {"cat": 0.25, "is_wet": 0.5})
    assert adopted_line(row) == (
        "revision 3 takes over from 2, its belief by replay of 12 steps, 1 of them counted for nothing; "
        "moved: is_wet by 0.500, cat by 0.250"
    )
