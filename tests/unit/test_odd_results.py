"""Results that are no plain data, or have too many levels: the message names the field."""

from typing import Any

import pytest

from aos_protocol.errors import SkillError
from aos_runtime.adapters.adapter import Call, Observed
from aos_runtime.adapters.results import result_of
from aos_runtime.adapters.settings import Binding

LEVELS = "it is nested too deeply (more than 64 levels), or contains itself"


def nested(levels: int) -> Any:
    value: Any = 0.5
    for _ in range(levels):
        value = [value]
    return value


def answered(answer: Any, binding: Binding) -> Any:
    call = Call("test-1", "/take", "take", {}, deadline_s=1.0)
    return result_of(call, binding, answer, {}, "arm")


def refusal(answer: Any, binding: Binding) -> str:
    with pytest.raises(SkillError) as refused:
        answered(answer, binding)
    assert (refused.value.code, bool(refused.value.hint)) == ("AOS504", True)
    return refused.value.message


@pytest.mark.parametrize("result", [None, {"picture": "picture"}, {"first": "picture[0][0]"}])
@pytest.mark.parametrize("levels", [65, 500, 20_000])
def test_a_field_with_too_many_levels_is_named(result: dict[str, str] | None, levels):
    message = refusal({"picture": nested(levels)}, Binding(result=result))
    assert message.startswith("the field picture of the result of /take cannot be ")
    assert message.endswith(LEVELS)


def test_a_field_may_have_many_levels():
    assert answered({"picture": nested(50)}, Binding(result={"picture": "picture"})).fields == {
        "picture": nested(50)
    }


def test_an_answer_that_is_no_mapping_is_shown_shortened():
    message = "/take answered [[[[[[[...]]]]]]], which is no mapping of field names to values"
    assert refusal(nested(5_000), Binding()) == message


@pytest.mark.parametrize(
    ("observed", "message"),
    [
        (Observed(nested(70)), f"the field response of the observation of /take cannot be sent: {LEVELS}"),
        (
            Observed("taken", {}, nested(1)),
            "the monitors of the observation of /take are [0.5], which is no mapping of names to values",
        ),
    ],
)
def test_an_observation_that_cannot_be_read_is_named(observed: Observed, message):
    assert refusal(observed, Binding()) == message


def test_the_fields_of_a_message_are_given_as_a_mapping_or_by_name():
    told: list[tuple[str, dict[str, Any]]] = []
    call = Call("test-1", "/take", "take", {}, 1.0, on_message=lambda *message: told.append(message))
    call.publish("/arm", gap_m=0.1)
    call.publish("/arm", {"gap_m": 0.1})
    assert told == [("/arm", {"gap_m": 0.1})] * 2
