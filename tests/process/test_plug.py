"""A share of `make plug`: what documents that change in mid-mission cost, and what is believed then."""

import logging

import pytest
from exam.generation import named_problem
from plug.pushes import played
from plug.shelf import interleaved
from plug.truth import examined


@pytest.mark.parametrize("name", ["doors/5", "machine/16"])
async def test_a_belief_by_replay_is_the_exact_posterior_and_a_projected_one_keeps_what_both_have(name):
    found = await examined(named_problem(name, 40))
    assert found.replay <= 1e-9
    assert found.kept <= 1e-12
    assert abs(found.drawn) <= 3


async def test_no_engine_is_asked_after_its_end_or_left(caplog):
    caplog.set_level(logging.CRITICAL)
    faults = {seed: result.faults for seed in range(150) if (result := await interleaved(seed)).faults}
    assert faults == {}


async def test_variables_that_come_and_change_in_mid_mission_are_believed_by_replay(tmp_path):
    mission = await played(
        tmp_path / "mission", 3, ("variable added", "variable retyped", "broken", "removed"), superseded=0.0
    )
    assert mission.faults == []
    assert [each.is_accepted for each in mission.pushed] == [True, True, False, True]
    assert [each.by for each in mission.pushed[:2]] == ["replay", "replay"]
