from typing import Any

import msgspec
import pytest

from aos_protocol.errors import SkillError
from aos_protocol.messages import Activate, ActivationId, Cancel, SkillCall
from aos_runtime.parties.fence import Fence, meaning


def a_request(step: int, *, epoch: int = 1, skill: str = "pick", **parameters: Any) -> Activate:
    return Activate(ActivationId("m", step), skill, parameters, 5.0, epoch=epoch)


def a_fence(*, solver_is_at: int | None) -> Fence:
    async def epoch(_: str) -> int | None:
        return solver_is_at

    return Fence(epoch)


async def code_of(fence: Fence, request: Activate) -> str:
    try:
        await fence.check(request)
    except SkillError as error:
        return error.code
    return ""


async def test_a_request_of_an_older_solver_is_refused():
    fence = a_fence(solver_is_at=2)
    fence.note(a_request(1, epoch=2))
    assert await code_of(fence, a_request(2, epoch=1)) == "AOS506"
    assert await code_of(fence, a_request(2, epoch=2)) == ""


async def test_an_epoch_counts_only_if_the_solver_says_that_it_is_his():
    fence = a_fence(solver_is_at=2)
    fence.note(a_request(1))
    assert await code_of(fence, a_request(2, epoch=999)) == "AOS506"
    assert await code_of(fence, a_request(2, epoch=2)) == ""
    assert await code_of(fence, a_request(2)) == "", "a refused epoch has made the mission's own one stale"


async def test_an_epoch_is_not_believed_while_the_solver_is_away():
    fence = a_fence(solver_is_at=None)
    fence.note(a_request(1))
    assert await code_of(fence, a_request(2, epoch=2)) == "AOS506"


@pytest.mark.parametrize("other", [a_request(1, skill="place"), a_request(1, side="left")])
async def test_an_id_stands_for_one_skill_with_its_parameters(other):
    fence = a_fence(solver_is_at=1)
    fence.note(a_request(1, side="right"))
    assert await code_of(fence, a_request(1, side="right")) == ""
    assert await code_of(fence, other) == "AOS514"


def test_the_order_of_parameters_means_nothing():
    assert meaning(a_request(1, a=1, b=2)) == meaning(a_request(1, b=2, a=1))


def test_the_fields_of_a_call_by_hand_are_what_it_stands_for():
    first, second = (SkillCall(ActivationId("by-hand", 7), "/pick", {"x": x}, 5.0) for x in (1, 2))
    assert meaning(first) != meaning(second)


def test_a_cancellation_of_an_older_solver_is_stale_and_one_by_hand_never():
    fence = a_fence(solver_is_at=2)
    fence.note(a_request(1, epoch=2))
    assert fence.is_stale(Cancel("late", ActivationId("m", 1), epoch=1))
    assert not fence.is_stale(Cancel("late", ActivationId("m", 1), epoch=2))
    assert not fence.is_stale(Cancel("enough"))


def of_mission(number: int, step: int = 1) -> Activate:
    """A request of a mission of a system that stays."""
    return Activate(ActivationId(f"20260101T000000Z-tiger-{number}", step), "pick", {}, 5.0)


async def test_a_mission_that_another_one_has_followed_moves_nothing_any_more():
    fence = a_fence(solver_is_at=1)
    fence.note(of_mission(9))
    fence.note(of_mission(10))
    assert await code_of(fence, of_mission(9, step=2)) == "AOS506"
    assert await code_of(fence, of_mission(10, step=2)) == ""
    assert await code_of(fence, of_mission(11)) == ""
    assert await code_of(fence, a_request(1)) == "", "missions of others are no business of this system's"


async def test_a_new_mission_has_epochs_of_its_own():
    fence = a_fence(solver_is_at=1)
    fence.note(msgspec.structs.replace(of_mission(1), epoch=4))
    assert await code_of(fence, of_mission(2)) == ""
