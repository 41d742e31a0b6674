import math

import msgspec
import pytest
from models import built_bundles, engine_of
from places import BUNDLES
from study.played import Played, play

from aos_deploy.places import cache_dir
from aos_language.load import read_bundle_files
from aos_protocol.errors import AosError
from aos_protocol.messages import Fault, PredictedObservation, TreeQuery, WhatIfQuery, WhyQuery
from aos_runtime.disk.journal import JournalRow
from aos_solver.study.study import Study

ROUGH = [BUNDLES / name for name in ("armadillo-finer", "armadillo-rough")]


def rough_files() -> dict[str, bytes]:
    return {name: text for bundle in ROUGH for name, text in read_bundle_files(bundle)[0].items()}


@pytest.fixture
async def played() -> Played:
    return await play(rough_files(), steps=2)


async def test_terms_add_up_and_the_choice_changes_where_it_is_said(played: Played):
    async with Study(played, cache_dir(), flips_s=math.inf) as study:
        why = await study.why(WhyQuery(2, instead="navigate(destination=easy_table)"))
        again = await study.why(WhyQuery(2, instead="navigate(destination=easy_table)"))
        assert again == why  # A question leaves the engine where it was.
        assert why.is_exact
        assert not why.remark
        assert abs(sum(term.value for term in why.terms) - why.value) < 1e-9
        assert abs(sum(term.other for term in why.terms) - why.other_value) < 1e-9
        assert sum(each.probability for each in why.expected) == pytest.approx(1)
        assert [each.response for each in why.expected if each.is_seen] == [
            played.mission.outcome(2).outcome.response
        ]
        after = played.mission.outcome(2)
        assert (why.update_s, why.update_effort) == (after.update_s, after.update_effort)
        assert why.update_s > 0 < why.update_effort.count("steps of the model")
        assert why.flips
        for flip in why.flips:
            assert flip.is_checked
            assert flip.high - flip.low <= 1e-3
            beyond = flip.low if flip.low < flip.now else flip.high
            short = flip.high if flip.low < flip.now else flip.low
            for probability, is_better in ((beyond, True), (short, False)):
                query = WhatIfQuery(2, believe=(f"{flip.variable}={flip.value}:{probability}",))
                found = await study.what_if(query)
                worth = {value.action: value.q for value in found.actions}
                assert (worth[why.other] > worth[why.action]) == is_better


async def test_a_decision_under_other_circumstances_is_that_of_a_mission_in_them(played: Played):
    async with Study(played, cache_dir()) as study:
        chosen = played.mission.decision(1).action
        forbidden = await study.what_if(WhatIfQuery(1, forbid=(chosen,)))
        assert forbidden.action != chosen == forbidden.before
        lines = (ROUGH[1] / "pick.sd").read_text().split("\n")
        place = f"pick.sd:{lines.index('__reward = -2;') + 1}"
        changed = await study.what_if(WhatIfQuery(1, change=(f"{place}=-20",)))
        assert changed.supposed == (f"{place}: -20 instead of -2",)
        assert changed.action != "pick"
        without = await study.what_if(WhatIfQuery(1, without=("pick",)))
        assert all(not value.action.startswith("pick") for value in without.actions)
        tree = await study.tree(TreeQuery(1, depth=2, branches=2))
        assert tree.root.actions[0].action == chosen
        async with engine_of(await built_bundles(ROUGH)) as engine:
            index = [action.name for action in engine.description.actions].index(chosen)
            predicted = {each.response: each.probability for each in (await engine.predict(index)).predicted}
        assert {response: p for response, p, _ in tree.root.actions[0].after} == predicted


async def test_what_cannot_be_supposed_is_told(played: Played):
    async with Study(played, cache_dir()) as study:
        for query, code, said in (
            (WhatIfQuery(1), "AOS530", "nothing is supposed"),
            (WhatIfQuery(9, forbid=("pick",)), "AOS501", "no decision of step 9"),
            (WhatIfQuery(1, forbid=("fly",)), "AOS501", "no action fly"),
            (WhatIfQuery(1, without=("fly",)), "AOS501", "no skill fly"),
            (WhatIfQuery(1, believe=("wings=true:1",)), "AOS501", "no variable wings"),
            (WhatIfQuery(1, believe=("robot_at=Corridor:0.5",)), "AOS530", "is excluded"),
        ):
            with pytest.raises(AosError, match=said) as caught:
                await study.what_if(query)
            assert caught.value.code == code
            assert caught.value.hint
            assert (await study.what_if(WhatIfQuery(1, forbid=("pick",)))).action != "pick"


async def test_an_action_that_a_person_chose_is_valued_by_a_search_of_the_study():
    played = await play(rough_files(), steps=1)
    chosen = played.mission.decision(1)
    asked = msgspec.structs.replace(
        chosen,
        action="observe_holding",
        skill="observe_holding",
        chosen_by="operator",
        actions=(),
        searches=(),
        planner="",
        outcome=None,
    )
    rows = [row for row in played.rows if row.kind == "begun"]
    text = msgspec.json.encode(asked).decode()
    played.rows = [*rows, JournalRow(len(rows) + 1, 0, "decision", text)]
    async with Study(played, cache_dir(), flips_s=0.0) as study:
        why = await study.why(WhyQuery(1))
        assert (why.action, why.chosen_by, why.other) == ("observe_holding", "operator", chosen.action)
        assert why.is_exact
        assert why.margin < 0
        other = await study.what_if(WhatIfQuery(1, forbid=("observe_holding",)))
        assert (other.action, other.before) == (chosen.action, "observe_holding")
        assert other.value_before == pytest.approx(why.value)


async def test_a_decision_whose_activation_brought_nothing_says_so(played: Played):
    record = played.mission.outcome(1)
    assert record is not None
    assert record.outcome is not None
    lost = msgspec.structs.replace(
        record.outcome, status="unknown", response="", fault=Fault("AOS504", "the adapter was lost")
    )
    text = msgspec.json.encode(msgspec.structs.replace(record, outcome=lost)).decode()
    place = next(
        place
        for place, row in enumerate(played.rows)
        if row.kind == "decision" and '"outcome":{' in row.payload
    )
    played.rows[place] = played.rows[place]._replace(payload=text)
    async with Study(played, cache_dir(), flips_s=0.0) as study:
        why = await study.why(WhyQuery(1))
    assert not any(each.is_seen for each in why.expected)
    assert "nothing was observed, its activation ended as unknown: the adapter was lost" in why.remark


async def test_an_action_of_a_script_is_explained_where_values_are_searched():
    played = await play(
        read_bundle_files(BUNDLES / "bench" / "tiger")[0], steps=1, planner="pomcp", simulations=4000
    )
    opened = "open(door=left_door)"
    asked = msgspec.structs.replace(
        played.mission.decision(1),
        action=opened,
        skill="open",
        chosen_by="script",
        actions=(),
        searches=(),
        planner="",
        predicted=(PredictedObservation("opened", 1.0),),
    )
    rows = [row for row in played.rows if row.kind == "begun"]
    text = msgspec.json.encode(asked).decode()
    played.rows = [*rows, JournalRow(len(rows) + 1, 0, "decision", text)]
    async with Study(played, cache_dir()) as study:
        why = await study.why(WhyQuery(1))
        assert (why.action, why.chosen_by, why.other, why.planner) == (opened, "script", "listen", "pomcp")
        assert why.margin < 0
        assert why.is_close == (why.simulations_to_tell > 0)
        found = await study.what_if(WhatIfQuery(1, forbid=("listen",)))
        assert found.before == opened
        assert "listen" not in {value.action for value in found.actions}


async def test_rewards_of_more_outcomes_than_can_be_listed_are_means_of_drawn_steps():
    files = read_bundle_files(BUNDLES / "bench" / "tiger")[0]
    tolls = "for (int i = 0; i < 16; i++) __reward -= AOS.Bernoulli(0.25) ? 1 : 0;"
    files["listen.sd"] = files["listen.sd"].replace(b"__reward = -1;", f"__reward = -1;\n{tolls}".encode())
    played = await play(files, steps=1, planner="pomcp", simulations=500)
    async with Study(played, cache_dir()) as study:
        why = await study.why(WhyQuery(1))
        assert "rewards of lines are means of 10,000 steps that were drawn" in why.remark
        of_listening = [term.value if why.action == "listen" else term.other for term in why.terms]
        assert any(amount == pytest.approx(-4, abs=0.1) for amount in of_listening), why.terms
        assert sum(term.value for term in why.terms) + why.rest == pytest.approx(why.value)
