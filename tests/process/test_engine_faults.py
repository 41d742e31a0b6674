import asyncio
import json
from asyncio.subprocess import PIPE

import pytest
from hostile.counters import counting
from lamp import LAMP
from models import built_text, engine_of_text
from processes import HANG_S
from projects import text_project

from aos_deploy.places import cache_dir
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import EngineDefectError, ModelError
from aos_protocol.messages import BeliefSummary
from aos_solver.building.build import BuiltModel
from aos_solver.child.blame import slow_code
from aos_solver.child.engine import Engine
from aos_solver.child.process.engine_child import PRINT_LIMIT_BYTES, EngineChild, EngineStart
from aos_solver.mission.models.model_shelf import ModelShelf
from aos_solver.mission.models.takeover import RunningModel

BROKEN_START = """initial_belief:
vector<int> none;
state.is_on = none.at(3);
"""


async def started(built: BuiltModel) -> Engine:
    return await Engine.start(built, seed=1)


def speaking(code: str) -> dict[str, str]:
    """The lamp with a skill whose response is a text."""
    return LAMP | {"tell.sd": f"project: lamp\ndynamic_model:\n{code}\n"}


async def test_a_response_is_any_text():
    code = r'__moduleResponseStr = AOS.Bernoulli(0.25) ? "a\tb\n\\n\"é" : "";'
    async with engine_of_text(speaking(code)) as engine:
        told = {each.response: each.probability for each in (await engine.predict(1)).predicted}
        assert told == {'a\tb\n\\n"é': pytest.approx(0.25), "": pytest.approx(0.75)}
        assert (await engine.update("tell", 'a\tb\n\\n"é')).probability == pytest.approx(0.25)


async def test_a_text_that_is_cut_within_a_letter_is_a_fault_at_its_line():
    async with engine_of_text(
        speaking('__moduleResponseStr = "aé";\n__moduleResponseStr.pop_back();')
    ) as engine:
        with pytest.raises(ModelError, match="no UTF-8 at its byte 1") as caught:
            await engine.predict(1)
    (told,) = caught.value.diagnostics
    assert (told.code, told.span.file, told.span.line) == ("AOS215", "tell.sd", 4)


async def test_documents_that_give_a_running_mission_no_belief_are_refused():
    shelf = ModelShelf(cache_dir(), lambda remark: None, started, lambda revision: True)
    wider = LAMP | {"lamp.ef": LAMP["lamp.ef"].replace("bool is_on", "int is_on") + BROKEN_START}
    project = text_project(wider)
    async with engine_of_text(LAMP) as engine:
        (refusal,) = await shelf.check(project, RunningModel(1, engine))
    await shelf.close()
    assert (refusal.code, refusal.span.file) == ("AOS112", "lamp.ef")
    assert "give the running mission no belief" in refusal.message


@pytest.mark.parametrize(
    ("code", "fault", "file"),
    [
        ("if (state.count > 0) *(volatile int*)nullptr = 1;", "AOS210", "press.sd"),
        ("while (state.count > 0) { state__.count = 1; }", "AOS211", "press.sd"),
    ],
)
async def test_documents_whose_code_would_end_a_running_mission_are_refused(code, fault, file):
    refusal = await refused(counting("lamp", "press", code=code, steps="1000"))
    assert (refusal.code, refusal.span.file) == (fault, file)


async def refused(documents: dict[str, str]) -> Diagnostic:
    """The one reason for which documents are not taken into a mission."""
    shelf = ModelShelf(cache_dir(), lambda remark: None, started, lambda revision: True)
    project = text_project(documents)
    good = counting("lamp", "press", steps="1000")
    async with engine_of_text(good) as engine:
        (refusal,) = await shelf.check(project, RunningModel(1, engine))
    await shelf.close()
    return refusal


async def test_that_documents_lead_a_running_mission_to_no_goal_is_told():
    lost = LAMP | {"lamp.ef": LAMP["lamp.ef"].replace("= 1;", "= 1, __isGoalState = true;")}
    lost["press.sd"] = lost["press.sd"].replace("!state.is_on", "false")
    warning = await refused(lost)
    assert (warning.is_error, warning.code, str(warning.span)) == (False, "AOS132", "lamp.ef:4:1")


def slow(name: str, rounds: int) -> str:
    """Code that takes so many rounds, of some 10 ns, to leave a variable as it is."""
    return (
        f"double root = 1; for (int i = 0; i < {rounds}; ++i) root = std::sqrt(root + 1); {name} += root > 9;"
    )


async def test_code_that_makes_steps_slow_is_told_at_its_statement():
    code = f"int quick = 1;\nquick += 2;\n{slow('state__.count', 40_000_000)}"
    refusal = await refused(counting("lamp", "press", code=code, steps="1000"))
    assert (refusal.code, str(refusal.span)) == ("AOS211", "press.sd:7:53")
    assert "of that here" in refusal.message


async def test_of_slow_code_in_many_places_the_environment_document_is_told():
    # Two steps look at the special states three times: each place takes a third.
    changes, moves = (slow(name, 30_000_000) for name in ("state_.count", "state__.count"))
    earns = slow("__reward", 20_000_000)
    documents = counting("lamp", "press", code=moves, steps="1000")
    documents["lamp.ef"] += f"{earns}\n\nextrinsic_code:\n{changes}\n"
    refusal = await refused(documents)
    assert (refusal.code, refusal.span.file) == ("AOS211", "lamp.ef")
    assert "no one place" in refusal.message


class SeenEngine:
    """An engine whose running piece of code and processor time are those of each look."""

    def __init__(self, looks: list[tuple[int, float]]):
        self.looks = looks
        self.is_done = asyncio.Event()

    @property
    def running_piece(self) -> int:
        return self.looks[0][0]

    def ran_s(self) -> float:
        if len(self.looks) > 1:
            return self.looks.pop(0)[1]
        self.is_done.set()
        return self.looks[0][1]

    async def begin(self, deadline_s: float) -> None: ...

    async def ask(self, *question: object) -> None:
        await self.is_done.wait()

    async def close(self) -> None: ...


async def test_time_in_which_nobody_could_look_is_shared_by_the_code_before_and_after(monkeypatch):
    seen = SeenEngine([(1, 0.0), (1, 1.0), (2, 5.0), (2, 6.0)])

    async def launched(*start: object) -> SeenEngine:
        return seen

    monkeypatch.setattr(EngineChild, "launch", launched)
    spent_s = await slow_code._times_s(await built_text(LAMP), EngineStart(seed=1, policy="widen"))
    assert spent_s == {1: 3.0, 2: 3.0}


async def test_an_engine_that_does_not_understand_says_so(tmp_path):
    built = await built_text(LAMP)
    command = [str(built.executable), "-1", "-1", "1", "widen", "12"]
    engine = await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE)
    answers, _ = await asyncio.wait_for(engine.communicate(b"sing\n"), timeout=HANG_S)
    assert json.loads(answers.splitlines()[-1])["fault"]["code"] == "AOS217"


async def test_a_fault_outside_of_the_documents_code_is_the_engines_and_says_what_to_report():
    built = await built_text(LAMP)
    child = await EngineChild.start(built, EngineStart(seed=1, policy="widen"))
    try:
        with pytest.raises(EngineDefectError, match=r"AOS217.*please report it with the bundle") as caught:
            await child.ask("step_world\taction=0x", dict, HANG_S)
        assert caught.value.diagnostics == ()
        assert (await child.ask("summary", BeliefSummary, HANG_S)).entropy == 0
    finally:
        await child.close()


async def test_a_model_that_prints_without_end_fills_no_log(capfd):
    shouting = LAMP["press.sd"] + "printf(\"%s\\n\", string(4000, 'x').c_str());\n"
    async with engine_of_text(LAMP | {"press.sd": shouting}) as engine:
        await engine.rate(0.3, seed=1)
    printed = capfd.readouterr().err
    assert "the rest is left out" in printed
    assert PRINT_LIMIT_BYTES <= len(printed) < PRINT_LIMIT_BYTES + 10_000
