"""The belief of a model that takes over a mission: import, replay or projection, and what is told of it."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from mappings import mapping_text
from models import built_text, engine_of

from aos_protocol.errors import ModelError
from aos_protocol.messages import Marginal
from aos_runtime.clock import SystemClock
from aos_solver.child.engine import Engine
from aos_solver.mission.past import Evidence, Past, updated
from aos_solver.mission.takeover import REPLAY_S, RunningModel, Successor, Takeover, distances

HALL = {
    "hall.ef": """project: hall
horizon: 3
define_type: Room
enum_members: Attic, Cellar, Yard
state_variable: Room cat
state_variable: bool is_wet
initial_belief:
state.cat = AOS.Bernoulli(0.25) ? Attic : Cellar;
extrinsic_code:
if (AOS.Bernoulli(0.1)) state_.is_wet = true;
reward_code:
if (state.cat == Yard) __reward = 1;
""",
    "look.sd": """project: hall
dynamic_model:
__moduleResponse = AOS.Bernoulli(state.cat == Attic ? 0.9 : 0.2) ? above : below;
""",
    "look.am": mapping_text(
        "above: answer == 'above'", "below: answer == 'below'", project="hall", skill="look"
    ),
}
BELL = "state_variable: bool has_bell\ninitial_belief:\n"
"""Stands before the initial belief of documents with another variable."""


def changed(**changes: tuple[str, str]) -> dict[str, str]:
    """The documents with a text in place of another one, by the file's name without its ending."""
    files = dict(HALL)
    for stem, (old, new) in changes.items():
        (name,) = (name for name in files if name.startswith(f"{stem}.") and old in files[name])
        files[name] = files[name].replace(old, new)
    return files


def with_bell(code: str) -> dict[str, str]:
    return changed(hall=("initial_belief:\n", f"{BELL}{code}\n"))


def looked(response: str) -> Evidence:
    return Evidence("look", "look", response)


@asynccontextmanager
async def hall(cache_dir: Path, past: Past) -> AsyncIterator[RunningModel]:
    """A mission by the documents, with a past."""
    async with engine_of(await built_text(HALL, cache_dir)) as engine:
        for evidence in past.steps:
            await updated(engine, evidence, past.refuted_below)
        yield RunningModel(1, engine)


def past_of(*steps: Evidence) -> Past:
    past = Past()
    past.steps += steps
    return past


async def taken(
    files: dict[str, str], cache_dir: Path, past: Past, clock: SystemClock
) -> tuple[Takeover, Engine]:
    """The takeover by other documents, with an engine that whoever asks closes."""
    engine = await Engine.start(await built_text(files, cache_dir), seed=1)
    async with hall(cache_dir, past) as running:
        successor = Successor(RunningModel(2, engine), clock)
        takeover = await successor.take_over(running, past)
    assert takeover is not None
    return takeover, engine


def marginal(marginals: Sequence[Marginal], variable: str) -> dict[str, float]:
    (found,) = (each.values for each in marginals if each.variable == variable)
    return found


async def test_the_same_state_is_imported(cache_dir: Path) -> None:
    past = past_of(looked("above"))
    takeover, engine = await taken(changed(look=("0.9", "0.8")), cache_dir, past, SystemClock())
    await engine.close()
    assert (takeover.row.by, takeover.row.moved) == ("import", {})
    # The belief is that of the documents before: 0.25 * 0.9 : 0.75 * 0.2.
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.6)


async def test_another_state_is_the_posterior_of_the_new_documents_given_the_past(cache_dir: Path) -> None:
    files = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
    files["look.sd"] = files["look.sd"].replace("0.9", "(state.has_bell ? 1.0 : 0.5)")
    takeover, engine = await taken(files, cache_dir, past_of(looked("above")), SystemClock())
    await engine.close()
    assert (takeover.row.by, takeover.row.steps, takeover.row.foreign) == ("replay", 1, 0)
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.1875 / (0.1875 + 0.15))
    assert takeover.row.moved == {"cat": pytest.approx(0.6 - 0.1875 / (0.1875 + 0.15))}


async def test_what_the_new_documents_lack_lets_extrinsic_changes_alone_act(cache_dir: Path) -> None:
    past = past_of(
        Evidence("whistle", "whistle", "done"),
        looked("beside"),
        Evidence("sing", "sing", ran_probability=0.5),
    )
    files = with_bell("state.has_bell = true;")
    engine = await Engine.start(await built_text(files, cache_dir), seed=1)
    async with hall(cache_dir, past_of()) as running:
        takeover = await Successor(RunningModel(2, engine), SystemClock()).take_over(running, past)
    await engine.close()
    assert takeover is not None
    assert (takeover.row.by, takeover.row.steps, takeover.row.foreign) == ("replay", 3, 3)
    assert marginal(takeover.belief.marginals, "is_wet")["true"] == pytest.approx(1 - 0.9**3)
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.25)


async def test_an_impossible_past_is_met_by_projection_which_keeps_what_both_have(cache_dir: Path) -> None:
    files = with_bell("state.has_bell = AOS.Bernoulli(0.5);")
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, cache_dir, past_of(looked("above")), SystemClock())
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


async def test_a_projected_variable_follows_those_that_never_change(cache_dir: Path) -> None:
    # Nothing but the initial belief sets `cat`, so the bell still hangs where it hung at the start.
    files = with_bell("")
    start = "state.cat = AOS.Bernoulli(0.25) ? Attic : Cellar;\n"
    files["hall.ef"] = files["hall.ef"].replace(start, f"{start}state.has_bell = state.cat == Attic;\n")
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, cache_dir, past_of(looked("above")), SystemClock())
    await engine.close()
    assert marginal(takeover.belief.marginals, "has_bell")["true"] == pytest.approx(0.6)


async def test_a_variable_of_another_type_is_new(cache_dir: Path) -> None:
    files = changed(hall=("Attic, Cellar, Yard", "Cellar, Attic, Yard"))
    files["look.sd"] = files["look.sd"].replace("state.cat == Attic ? 0.9 : 0.2", "0.0")
    takeover, engine = await taken(files, cache_dir, past_of(looked("above")), SystemClock())
    await engine.close()
    assert takeover.row.by == "projection"
    assert marginal(takeover.belief.marginals, "cat")["Attic"] == pytest.approx(0.25)
    assert marginal(takeover.belief.marginals, "is_wet")["true"] == pytest.approx(0.1)


async def test_a_replay_that_would_take_too_long_is_a_projection(cache_dir: Path) -> None:
    class SlowClock(SystemClock):
        """A second passes with each look at it."""

        def __init__(self) -> None:
            self.now_s = 0.0

        def monotonic_s(self) -> float:
            self.now_s += 1.0
            return self.now_s

    past = past_of(*[looked("below")] * 20)
    files = with_bell("state.has_bell = true;")
    takeover, engine = await taken(files, cache_dir, past, SlowClock())
    await engine.close()
    assert takeover.row.by == "projection"
    assert takeover.row.why == "the replay of 20 steps would take about 20 s"
    assert REPLAY_S < 20


async def test_nothing_in_common_after_an_impossible_past_is_no_belief(cache_dir: Path) -> None:
    files = changed(hall=("is_wet", "is_dry"))
    files = {name: text.replace("cat", "dog") for name, text in files.items()}
    files["look.sd"] = files["look.sd"].replace("state.dog == Attic ? 0.9 : 0.2", "0.0")
    with pytest.raises(ModelError, match="no variable of the running model") as caught:
        await taken(files, cache_dir, past_of(looked("above")), SystemClock())
    assert caught.value.code == "AOS112"


def test_the_distance_of_marginals_is_half_of_what_their_values_differ_by() -> None:
    before = (Marginal("a", {"x": 0.5, "y": 0.5}), Marginal("b[0]", {"1": 1.0}), Marginal("c", {"1": 1.0}))
    after = (Marginal("a", {"x": 0.75, "z": 0.25}), Marginal("b[0]", {"2": 1.0}), Marginal("c", {"2": 1.0}))
    assert distances(before, after, ("a", "b")) == {"a": 0.5, "b[0]": 1.0}
