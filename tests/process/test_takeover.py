from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
import pytest
from hall import HALL, changed, looked, marginal, past_of, with_bell
from models import built_text, engine_of_text

from aos_protocol.errors import ModelError
from aos_protocol.messages import BeliefSummary, Marginal
from aos_runtime.clock import SystemClock
from aos_solver.child.answers.beliefs import ExportedBeliefs
from aos_solver.child.engine import Engine
from aos_solver.mission.models.past import Evidence, Past, updated
from aos_solver.mission.models.takeover import REPLAY_S, RunningModel, Successor, Takeover, distances


@asynccontextmanager
async def hall(past: Past) -> AsyncIterator[RunningModel]:
    async with engine_of_text(HALL) as engine:
        for evidence in past.steps:
            await updated(engine, evidence, past.refuted_below)
        yield RunningModel(1, engine)


async def taken(files: dict[str, str], past: Past, clock: SystemClock) -> tuple[Takeover, Engine]:
    """The takeover by other documents, with an engine that whoever asks closes."""
    engine = await Engine.start(await built_text(files), seed=1)
    async with hall(past) as running:
        successor = Successor(RunningModel(2, engine), clock)
        takeover = await successor.take_over(running, past)
    assert takeover is not None
    return takeover, engine


PURR = """project: hall
monitor: purr
response: ringing
response_rule: is_ringing
response: silent
response_rule: True

local_variable: is_ringing
topic: /bell
message_type: Bell
type: bool
code:
return __input.is_ringing
"""


class SlowClock(SystemClock):
    def __init__(self, step_s: float = 4.0):
        self._now_s, self._step_s = 0.0, step_s

    def monotonic_s(self) -> float:
        self._now_s += self._step_s
        return self._now_s


async def test_the_same_state_is_imported():
    past = past_of(looked("above"))
    takeover, engine = await taken(changed(look=("0.9", "0.8")), past, SystemClock())
    await engine.close()
    assert (takeover.row.by, takeover.row.moved) == ("import", {})
    # The belief is that of the documents before: 0.25 * 0.9 : 0.75 * 0.2.
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.6)


async def test_where_the_same_state_cannot_be_imported_the_past_is_replayed():
    async def refuse(_: ExportedBeliefs) -> BeliefSummary:
        raise ModelError("the state does not fit")

    past = past_of(looked("above"))
    engine = await Engine.start(await built_text(changed(look=("0.9", "0.8"))), seed=1)
    engine.import_beliefs = refuse
    async with hall(past) as running:
        successor = Successor(RunningModel(2, engine), SystemClock())
        assert await successor.take_over(running, past) is None
        takeover = await successor.take_over(running, past)
    await engine.close()
    assert takeover is not None
    assert (takeover.row.by, takeover.row.steps) == ("replay", 1)
    assert takeover.row.why == "AOS201: the state does not fit"


async def test_another_state_is_the_posterior_of_the_new_documents_given_the_past():
    files = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
    files["look.sd"] = files["look.sd"].replace("0.9", "(state.has_bell ? 1.0 : 0.5)")
    takeover, engine = await taken(files, past_of(looked("above")), SystemClock())
    await engine.close()
    assert (takeover.row.by, takeover.row.steps, takeover.row.foreign) == ("replay", 1, 0)
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.1875 / (0.1875 + 0.15))
    assert takeover.row.moved == {"cat": pytest.approx(0.6 - 0.1875 / (0.1875 + 0.15))}


async def test_what_the_new_documents_lack_lets_extrinsic_changes_alone_act():
    past = past_of(
        Evidence("whistle", "whistle", "done"),
        looked("beside"),
        Evidence("sing", "sing", ran_probability=0.5),
    )
    files = with_bell("state.has_bell = true;")
    engine = await Engine.start(await built_text(files), seed=1)
    async with hall(past_of()) as running:
        takeover = await Successor(RunningModel(2, engine), SystemClock()).take_over(running, past)
    await engine.close()
    assert takeover is not None
    assert (takeover.row.by, takeover.row.steps, takeover.row.foreign) == ("replay", 3, 3)
    assert marginal(takeover.belief.marginals, "is_wet")["true"] == pytest.approx(1 - 0.9**3)
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.25)


async def test_an_impossible_past_is_met_by_projection_which_keeps_what_both_have():
    files = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, past_of(looked("above")), SystemClock())
    exported = await engine.export_joint(engine.layout.common_with(engine.layout))
    await engine.close()
    assert takeover.row.by == "projection"
    assert takeover.row.why == "step 1, look -> above, is impossible in the new documents"
    assert takeover.row.moved == {}
    (belief,) = exported.beliefs
    joint = {values: weight for weight, _, _, values in belief.rows}
    # cat, is_wet, has_bell
    kept = {"0": 0.6, "1": 0.4}
    wet = {"0": 0.9, "1": 0.1}
    assert joint == {
        f"{cat} {is_wet} {bell}": pytest.approx(kept[cat] * wet[is_wet] * 0.5, abs=1e-12)
        for cat in kept
        for is_wet in wet
        for bell in "01"
    }


async def test_what_a_monitor_said_may_be_impossible_too():
    files = with_bell("state.has_bell = false;")
    files["hall.ef"] += "monitor: purr\ncode:\n__moduleResponse = state.has_bell ? ringing : silent;\n"
    files["purr.am"] = PURR
    heard = msgspec.structs.replace(looked("above"), monitors={"purr": "ringing"})
    takeover, engine = await taken(files, past_of(looked("below"), heard), SystemClock())
    await engine.close()
    assert takeover.row.by == "projection"
    assert takeover.row.why == "what a monitor said after step 2 is impossible in the new documents"


async def test_a_projected_variable_follows_those_that_never_change():
    # Nothing but the initial belief sets `cat`, so the bell still hangs where it hung at the start.
    files = with_bell("")
    start = "state.cat = AOS.Bernoulli(0.25) ? Attic : Cellar;\n"
    files["hall.ef"] = files["hall.ef"].replace(start, f"{start}state.has_bell = state.cat == Attic;\n")
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, past_of(looked("above")), SystemClock())
    await engine.close()
    assert marginal(takeover.belief.marginals, "has_bell")["true"] == pytest.approx(0.6)


async def test_a_variable_of_another_type_is_new():
    files = changed(hall=("Attic, Cellar, Yard", "Cellar, Attic, Yard"))
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, past_of(looked("above")), SystemClock())
    await engine.close()
    assert takeover.row.by == "projection"
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.25)
    assert marginal(takeover.belief.marginals, "is_wet")["true"] == pytest.approx(0.1)


async def test_a_replay_that_would_take_too_long_is_a_projection():
    past = past_of(*[looked("below")] * 20)
    files = with_bell("state.has_bell = true;")
    takeover, engine = await taken(files, past, SlowClock(1.0))
    await engine.close()
    assert takeover.row.by == "projection"
    assert takeover.row.why == "the replay of 20 steps would take about 20 s"
    assert REPLAY_S < 20


async def test_nothing_in_common_after_an_impossible_past_is_no_belief():
    files = changed(hall=("is_wet", "is_dry"))
    files = {name: text.replace("cat", "dog") for name, text in files.items()}
    files["look.sd"] = files["look.sd"].replace("state.dog == Attic ? 0.9 : 0.2", "0.0")
    with pytest.raises(ModelError, match="no variable of the running model") as caught:
        await taken(files, past_of(looked("above")), SystemClock())
    assert caught.value.code == "AOS112"


async def test_a_projection_keeps_what_nobody_observed_apart():
    # With its time the skill may have run three times, or never: 1 - 0.9 ** 3 of one half.
    past = past_of(*[Evidence("look", "look", ran_probability=0.5)] * 3)
    files = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
    engine = await Engine.start(await built_text(files), seed=1)
    async with hall(past) as running:
        takeover = await Successor(RunningModel(2, engine), SlowClock()).take_over(running, past)
        assert takeover is not None
        assert takeover.row.by == "projection"
        before = await running.engine.update("look", "above")
        after = await engine.update("look", "above")
    await engine.close()
    assert marginal(takeover.belief.marginals, "is_wet")["true"] == pytest.approx((1 - 0.9**3) / 2)
    assert takeover.belief.cautious is not None
    for variable in ("cat", "is_wet"):
        told = marginal(after.summary.marginals, variable)
        assert told == pytest.approx(marginal(before.summary.marginals, variable))


async def test_a_projection_of_particles_keeps_their_weights():
    past = past_of(*[looked("below")] * 3)
    files = with_bell("state.has_bell = AOS.Bernoulli(0.25);")
    engine = await Engine.start(await built_text(files), seed=1)
    async with engine_of_text(HALL) as old:
        await old.draw_belief()
        for evidence in past.steps:
            await updated(old, evidence, past.refuted_below)
        takeover = await Successor(RunningModel(2, engine), SlowClock()).take_over(RunningModel(1, old), past)
        assert takeover is not None
        common = old.layout.common_with(engine.layout)
        (before,), (after,) = [(await each.export_joint(common)).beliefs for each in (old, engine)]
    await engine.close()
    kept = [{values: weight for weight, _, _, values in belief.rows} for belief in (before, after)]
    assert kept[0] == pytest.approx(kept[1], abs=1e-12)
    assert takeover.belief.error_bound == 1
    assert marginal(takeover.belief.marginals, "has_bell")["true"] == pytest.approx(0.25, abs=0.02)


async def test_a_projection_keeps_what_has_counted_once_where_both_have_the_same_code():
    once = "reward_code:\nif (state.cat == Attic) {{ __reward = {}; __stopEvaluatingState = true; }}\n"
    files = with_bell("state.has_bell = false;")
    files["hall.ef"] += once.format(5) + once.format(7)
    old = dict(HALL)
    old["hall.ef"] += once.format(7)
    past = past_of(*[looked("above")] * 3)
    engine = await Engine.start(await built_text(files), seed=1)
    async with engine_of_text(old) as running:
        for evidence in past.steps:
            await updated(running, evidence, past.refuted_below)
        common = running.layout.common_with(engine.layout)
        assert common.bits == {1: 2}
        await engine.project(await running.export_joint(common), common)
        (before,), (after,) = [
            (await each.export_joint(each.layout.common_with(each.layout))).beliefs
            for each in (running, engine)
        ]
    await engine.close()
    spent = {int(bits) & 2 for _, _, bits, values in after.rows if values.startswith("0 ")}
    assert spent == {2 * int(bits) for _, _, bits, values in before.rows if values.startswith("0 ")} == {2}
    assert {int(bits) & 2 for _, _, bits, values in after.rows if values.startswith("1 ")} == {0}


def test_the_distance_of_marginals_is_half_of_what_their_values_differ_by():
    before = (Marginal("a", {"x": 0.5, "y": 0.5}), Marginal("b[0]", {"1": 1.0}), Marginal("c", {"1": 1.0}))
    after = (Marginal("a", {"x": 0.75, "z": 0.25}), Marginal("b[0]", {"2": 1.0}), Marginal("c", {"2": 1.0}))
    assert distances(before, after, ("a", "b")) == {"a": 0.5, "b[0]": 1.0}
