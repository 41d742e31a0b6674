import pytest
from wrong_robots import Wrong, tried_by_model, wrong_robots

WRONG = wrong_robots()


def test_no_claim_is_without_a_robot_that_does_otherwise():
    assert [f"{wrong.name}: {wrong.claim.says}" for wrong in WRONG if wrong.robot is None] == []


@pytest.mark.parametrize(
    "wrong",
    [wrong for wrong in WRONG if wrong.robot is not None and wrong.claim.only != "system"],
    ids=lambda wrong: f"{wrong.name}: {wrong.claim.says}",
)
async def test_a_claim_fails_on_a_robot_that_does_otherwise(wrong: Wrong):
    verdict = await tried_by_model(wrong)
    assert verdict.missions > 0, "the claim is about none of its missions"
    assert not verdict.is_seen
