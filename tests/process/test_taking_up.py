import msgspec
import pytest
from models import engine_of
from scripted_missions import Surroundings, breaking, observed

from aos_protocol.errors import StorageError
from aos_protocol.messages import (
    Activate,
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    Message,
    MissionBegun,
    MissionState,
    Outcome,
)
from aos_protocol.mission_rows import BEGUN
from aos_runtime.disk.journal import JournalRow
from aos_solver.building.build import BuiltModel
from aos_solver.child.search import Search
from aos_solver.mission.loop import Mission
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.records.memory import MissionMemory, folded
from aos_solver.mission.rules.endings import MissionLimits
from aos_solver.mission.rules.failures import FailureRules, SkillRule
from aos_solver.mission.rules.terms import Terms

RULES = FailureRules(skills={"listen": SkillRule(on_failure="retry", retries=1)})


robot = breaking(jams=2, is_late=4)


def rows_of(journalled: list[tuple[str, Message]]) -> list[JournalRow]:
    return [
        JournalRow(number, number, kind, msgspec.json.encode(payload))
        for number, (kind, payload) in enumerate(journalled, start=1)
    ]


async def played(
    built: BuiltModel, memory: MissionMemory, calls: list[Activate]
) -> tuple[MissionState, Surroundings]:
    def counted(request: Activate) -> Outcome:
        calls.append(request)
        return robot(request)

    around = Surroundings(counted)
    begun = MissionBegun("m", memory.epoch + 1, 1, 1, "digest")
    around.journal(BEGUN, begun)
    terms = Terms(
        name="m",
        epoch=begun.epoch,
        limits=MissionLimits(step_limit=7, goal_probability=2.0),
        search=Search(simulations=2_000, seed=1),
        activation_timeout_s=1.0,
        failures=RULES,
    )
    async with engine_of(built) as engine:
        return await Mission(terms, RunningModel(1, engine), around, memory).run(), around


def beliefs(
    journalled: list[tuple[str, Message]],
) -> list[tuple[int, int, str, BeliefSummary, Outcome | None]]:
    """Returns each record without the search, whose tree is not kept."""
    records = [record for _, record in journalled if isinstance(record, DecisionRecord)]
    return [(each.sequence, each.step, each.remark, each.belief, each.outcome) for each in records]


async def test_a_mission_cut_off_at_any_row_goes_on_with_the_belief_of_its_undisturbed_twin(
    tiger: BuiltModel,
):
    whole_calls: list[Activate] = []
    whole_state, whole = await played(tiger, MissionMemory(), whole_calls)
    whole_rows = rows_of(whole.journalled)
    twin = folded(whole_rows)
    assert len(twin.steps) == 7
    for cut in range(1, len(whole_rows)):
        before = folded(whole_rows[:cut])
        calls: list[Activate] = []
        state, rest = await played(tiger, before, calls)
        journalled = [*whole.journalled[:cut], *rest.journalled]
        memory = folded(rows_of(journalled))
        assert (state.ending, state.step) == (whole_state.ending, whole_state.step)
        assert [sequence for sequence, *_ in beliefs(journalled)] == list(range(14))
        # The step that was not over, too, ends as it does in the twin, and with the same belief.
        until = 2 * len(before.steps) + 2 * (before.pending is not None)
        assert beliefs(journalled)[:until] == beliefs(whole.journalled)[:until], (
            f"after row {cut}, {whole_rows[cut - 1].kind}"
        )
        # What has an outcome in the journal is not asked for again, and all else is, by the new solver.
        known = {payload.id for _, payload in whole.journalled[:cut] if isinstance(payload, Outcome)}
        assert [call.id for call in calls] == [call.id for call in whole_calls if call.id not in known]
        assert {call.epoch for call in calls} <= {memory.epoch} == {2}


def test_an_empty_journal_folds_to_the_start():
    assert folded([]) == MissionMemory()


def test_a_damaged_row_is_named():
    with pytest.raises(StorageError, match="row 3, decision, cannot be read") as error:
        folded([JournalRow(3, 0, "decision", b"{")])
    assert error.value.code == "AOS702"


def test_an_outcome_without_a_decision_is_no_journal():
    outcome = observed(Activate(ActivationId("m", 1), "listen", {}, 1.0), "x")
    with pytest.raises(StorageError, match="row 1 of the journal, outcome, follows no decision"):
        folded(rows_of([("outcome", outcome)]))
