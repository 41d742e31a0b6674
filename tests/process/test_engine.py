import os
import signal
from pathlib import Path

import pytest
from models import built_bundle, built_bundles, engine_of, engine_of_bundle, engine_of_text
from places import BUNDLES, DATA
from processes import descendants, kill_engine, until_ended

from aos_protocol.errors import ModelError
from aos_solver.building.build import BuiltModel
from aos_solver.child.process import engine_child
from aos_solver.child.process.engine_child import EngineChild, EngineStart

EXACT_AT_8 = {
    "rough": {
        "pick": 2.713,
        "observe_holding": 1.473,
        "observe_arm_outstretched": 1.473,
        "navigate(destination=easy_table)": -2.527,
    },
    "finer": {
        "navigate(destination=easy_table)": 3.110,
        "observe_holding": 1.580,
        "observe_arm_outstretched": 1.580,
        "pick": 0.219,
    },
}
"""Computed by an independent program, for a look-ahead of eight decisions."""

CORPUS_NAMES = {
    "pick": "basic_pick",
    "observe_holding": "observe_holding_can",
    "observe_arm_outstretched": "observe_arm_outstretched",
    "navigate(destination=corridor)": "navigate(oDesiredLocation=locationCorridor)",
    "navigate(destination=easy_table)": "navigate(oDesiredLocation=locationAuditorium_toCan1)",
    "navigate(destination=hard_table)": "navigate(oDesiredLocation=locationAuditorium_toCan2)",
    "serve": "serve_can_to_person",
}


async def _exact(*bundles: Path) -> dict[str, float]:
    async with engine_of(await built_bundles(bundles)) as engine:
        return {value.action: value.q for value in (await engine.exact_values(8)).actions}


async def test_an_answer_that_takes_long_tells_how_far_it_is_and_is_the_same():
    texts: list[str] = []
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        engine.on_progress = lambda progress: texts.append(progress.text)
        await engine.tell_progress(0)
        heard = (await engine.exact_values(4)).actions
        await engine.tell_progress(100)
        assert (await engine.exact_values(4)).actions == heard
    assert any(text.startswith("listing states: ") for text in texts)


@pytest.mark.parametrize("kind", ["rough", "finer"])
async def test_exact_values_of_our_armadillo_are_the_published_ones(kind):
    values = await _exact(BUNDLES / "armadillo-finer", BUNDLES / f"armadillo-{kind}")
    assert EXACT_AT_8[kind] == pytest.approx({name: values[name] for name in EXACT_AT_8[kind]}, abs=5e-4)


@pytest.mark.corpus
@pytest.mark.parametrize("kind", ["rough", "finer"])
async def test_each_action_of_the_original_armadillo_is_worth_what_ours_is(kind, corpus: Path):
    ours = await _exact(BUNDLES / "armadillo-finer", BUNDLES / f"armadillo-{kind}")
    theirs = await _exact(corpus / f"armadillo-{kind}")
    renamed = {CORPUS_NAMES[name]: value for name, value in ours.items()}
    assert theirs == pytest.approx(renamed, abs=1e-9)


async def test_an_impossible_observation_is_an_event_and_leaves_a_belief():
    built = await built_bundle(BUNDLES / "armadillo-finer")
    async with engine_of(built, impossible_observation="hold") as engine:
        update = await engine.update("observe_holding", "holding")
    assert update.is_impossible
    assert update.probability == 0
    assert update.summary.states == 1


async def test_a_frozen_engine_is_killed_and_comes_back_with_its_belief(monkeypatch):
    monkeypatch.setattr(engine_child, "FROZEN_S", 0.1)
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        before = (await engine.update("pick", "pick_succeeded")).summary
        assert engine.pid is not None
        children = descendants(engine.pid)
        for child in children:
            os.kill(child, signal.SIGSTOP)
        assert await engine.summary() == before
        await until_ended(children)


async def test_an_engine_that_is_killed_while_it_is_started_anew_comes_back_as_well(monkeypatch):
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        before = (await engine.update("pick", "pick_succeeded")).summary
        start, killed = EngineChild.start, []

        async def start_and_kill(built: BuiltModel, beginning: EngineStart) -> EngineChild:
            child = await start(built, beginning)
            if len(killed) < 3:
                killed.append(child.pid)
                below = descendants(child.pid)
                os.kill(child.pid, signal.SIGKILL)
                await until_ended(below)
            return child

        monkeypatch.setattr(EngineChild, "start", start_and_kill)
        await kill_engine(engine.pid)
        assert await engine.summary() == before
        assert len(killed) == 3


async def test_an_engine_that_is_killed_while_it_is_started_is_started_again(monkeypatch):
    launch, killed = EngineChild.launch, []

    async def launch_and_kill(built: BuiltModel, beginning: EngineStart) -> EngineChild:
        child = await launch(built, beginning)
        if len(killed) < 3:
            killed.append(child.pid)
            os.kill(child.pid, signal.SIGKILL)
        return child

    built = await built_bundle(BUNDLES / "armadillo-finer")
    monkeypatch.setattr(EngineChild, "launch", launch_and_kill)
    async with engine_of(built) as engine:
        assert (await engine.summary()).states > 0
    assert len(killed) == 3


async def test_an_engine_that_crashes_between_documents_says_what_may_have_harmed_it():
    async with engine_of_bundle(BUNDLES / "armadillo-finer") as engine:
        assert engine.pid is not None
        (child,) = descendants(engine.pid)
        os.kill(child, signal.SIGSEGV)
        with pytest.raises(ModelError, match=r"outside of the documents' code \(signal 11\)") as caught:
            await engine.summary()
    assert caught.value.code == "AOS213"
    assert "through a pointer" in caught.value.hint


async def test_model_code_that_crashes_is_named_by_its_document_line():
    tiger = DATA / "bundles/tiger"
    crashing = {path.name: path.read_text() for path in tiger.iterdir()}
    crashing["listen.sd"] = (
        "project: tiger\n\ndynamic_model:\nint* nothing = nullptr;\n*nothing = 1;\n"
        "__moduleResponse = hears_left;\n__moduleResponse = hears_right;\n"
    )
    listening = (0).to_bytes(4, "little")
    async with engine_of_text(crashing) as engine:
        with pytest.raises(ModelError, match=r"listen\.sd:5") as error:
            await engine.plan(simulations=100, seed=1, planner="pomcp")
        assert error.value.code == "AOS210"
        assert "signal 11" in str(error.value)
        await engine.reset_worlds([1])
        with pytest.raises(ModelError, match=r"listen\.sd:5"):
            await engine.step_worlds(listening)
        assert (await engine.summary()).states == 2
