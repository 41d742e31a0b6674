import pytest
from models import built_text, engine_of, engine_of_text
from processes import kill_engine
from projects import text_project

from aos_deploy.places import cache_dir
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, PlanningError
from aos_protocol.messages import StartMission
from aos_solver.child.engine import Engine
from aos_solver.child.search import Search
from aos_solver.mission.conditions import built_with_conditions
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.records.logbook import Logbooks
from aos_solver.mission.rules.terms import Terms
from aos_solver.mission.succession import Succession, begin_with

WALK = {
    "walk.ef": """\
project: walk
horizon: 5
discount: 0.9

state_variable: int place
code:
state.place = 0;

state_variable: bool paid
code:
state.paid = false;

initial_belief:
state.place = AOS.SampleDiscrete(vector<double>{0.5, 0.3, 0.2});

extrinsic_code:
if (AOS.Bernoulli(0.25)) state_.place = (state.place + 1) % 3;

reward_code:
if (state.place == 2) {
    __reward = 1;
    __stopEvaluatingState = true;
}

reward_code:
if (state.place == 9) {
    __reward = 1;
    __isGoalState = true;
}
""",
    "look.sd": """\
project: walk
dynamic_model:
__moduleResponse = AOS.Bernoulli(state.place == 0 ? 0.9 : 0.2) ? low : high;
__reward = -1;
""",
}


async def distribution(engine: Engine) -> dict[str, float]:
    belief = await engine.export_belief()
    assert belief.error_bound == 0
    return {state: weight for weight, state in belief.particles}


def project() -> Project:
    return text_project(WALK)


def after_time(places: list[float], steps: int) -> list[float]:
    for _ in range(steps):
        places = [0.75 * places[at] + 0.25 * places[at - 1] for at in range(3)]
    return places


@pytest.mark.parametrize("idle", [0, 1, 3])
@pytest.mark.parametrize("given", [(), ("state.place != 1",)])
@pytest.mark.parametrize("is_kept", [False, True])
async def test_a_beginning_is_the_belief_by_enumeration(idle, given, is_kept):
    built = await built_text(WALK)
    start = StartMission("keep" if is_kept else "initial", given, idle)

    async def conditioned() -> Engine:
        return await Engine.start(await built_with_conditions(project(), given, cache_dir()), seed=1)

    async with engine_of(built) as last, engine_of(built) as engine:
        places = [0.5, 0.3, 0.2]
        kept = None
        if is_kept:
            await last.update("look", "low")
            places = after_time([0.5 * 0.9, 0.3 * 0.2, 0.2 * 0.2], 1)
            kept = await last.export_beliefs()
        await begin_with(engine, start, kept, conditioned, 0.01)
        places = after_time(places, idle)
        weights = [weight for at, weight in enumerate(places) if not given or at != 1]
        believed = await distribution(engine)
        assert sorted(believed.values()) == pytest.approx(
            sorted(weight / sum(weights) for weight in weights), abs=1e-12
        )
        # The flag of a special state that counts once is set for place 2 alone: nothing of before is left.
        assert len(believed) == len(weights)


async def test_a_state_that_had_ended_goes_on_in_the_next_mission():
    files = WALK | {"walk.ef": WALK["walk.ef"].replace("state.place == 9", "state.place == 1")}
    async with engine_of_text(files) as engine:
        assert (await engine.summary()).goal_probability == pytest.approx(0.3)
        places = [0.5, 0.3, 0.2]
        began = await engine.begin_mission(idle=2)
        assert began.goal_probability == pytest.approx(after_time(places, 2)[1])


async def test_what_is_impossible_begins_nothing():
    given = ("state.place == 7",)

    async def conditioned() -> Engine:
        return await Engine.start(await built_with_conditions(project(), given, cache_dir()), seed=1)

    async with engine_of_text(WALK) as engine:
        before = await distribution(engine)
        with pytest.raises(PlanningError, match=r"`state\.place == 7` has probability 0") as refused:
            await begin_with(engine, StartMission(given=given), None, conditioned, 0.01)
        assert refused.value.code == "AOS516"
        assert await distribution(engine) == before


async def test_a_condition_of_probability_0_leaves_the_belief_also_to_the_next_process():
    async with await Engine.start(
        await built_with_conditions(project(), ("state.place == 7",), cache_dir()), seed=1
    ) as aside:
        before = (await aside.update("look", "low")).summary
        for _ in range(2):
            answer = await aside.condition(0.01)
            assert (answer.probability, answer.summary) == (0.0, before)
            await kill_engine(aside.pid)
            assert await aside.summary() == before


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("state.plaze == 1", "AOS110", "--given:1:7"),
        ("state.place == 1; true", "AOS108", "--given:1:17"),
        ("AOS.Bernoulli(0.5)", "AOS142", "--given:1:1"),
        ("true", "AOS142", "--given:1:1"),
        ("state__.place == 1", "AOS110", "--given:1:1"),
        ("state.place = 1", "AOS123", "--given:1:1"),
        ("", "AOS142", "--given:1:1"),
        ('state.place == "x"', "AOS201", "--given:1:13"),
    ],
)
async def test_a_condition_that_cannot_be_used_is_told_with_its_column(text, code, place):
    with pytest.raises(AosError, match="what is given has errors") as refused:
        await built_with_conditions(project(), [text], cache_dir())
    (found, *_) = refused.value.diagnostics
    assert (found.code, str(found.span)) == (code, place)


async def test_a_condition_that_faults_is_told_at_its_place():
    built = await built_with_conditions(project(), ["1 / (state.place - 1) == 0"], cache_dir())
    async with engine_of(built) as engine:
        with pytest.raises(AosError, match="--given:1:1"):
            await engine.condition(0.01)


async def test_a_belief_is_kept_from_a_mission_before(tmp_path):
    def terms(name: str, seed: int, epoch: int, running: RunningModel) -> Terms:
        return Terms(name=name, epoch=epoch, search=Search(simulations=1, seed=seed))

    async def documents(revision: int) -> Project:
        return project()

    succession = Succession(Logbooks(tmp_path, 1, stay=True), terms, documents, cache_dir())
    async with engine_of_text(WALK) as engine:
        with pytest.raises(PlanningError, match="there is no mission before this one") as refused:
            await succession.next(RunningModel(1, engine), StartMission("keep"), None)
        assert refused.value.code == "AOS516"
        begun = await succession.next(RunningModel(1, engine), StartMission(), None)
        assert await distribution(begun.engine) == await distribution(engine)
        await begun.engine.close()
