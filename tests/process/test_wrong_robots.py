import pytest
from wrong_robots import EXPERIMENTS, tried_by_model, wrong_robots


@pytest.mark.parametrize("experiment", EXPERIMENTS)
def test_no_claim_is_without_a_robot_that_does_otherwise(experiment: str):
    wrongs = wrong_robots(experiment)
    assert wrongs
    assert [f"{wrong.name}: {wrong.claim.says}" for wrong in wrongs if wrong.robot is None] == []


@pytest.mark.parametrize("experiment", EXPERIMENTS)
async def test_a_claim_fails_on_a_robot_that_does_otherwise(experiment: str):
    """A claim is about missions of the robot, and not seen in them."""
    held = []
    for wrong in wrong_robots(experiment):
        if wrong.robot is not None and wrong.claim.only != "system":
            verdict = await tried_by_model(wrong)
            if verdict.missions == 0 or verdict.is_seen:
                held.append(f"{wrong.name}: {wrong.claim.says}: {verdict}")
    assert held == []
