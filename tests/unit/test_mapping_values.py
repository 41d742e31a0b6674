import math
from enum import Enum
from typing import Any

import numpy as np
import pytest

from aos_middleware.workers.values import Message, low_level_type, message_from, plain_from, stand_in, text_of


class RosMessage:
    """A class with the shape of a ROS 1 message class: fields in `__slots__`."""

    __slots__ = ("_connection", "header", "x")

    def __init__(self):
        self.header = {"seq": 1}
        self.x = 2.5
        self._connection = object()


def test_nested_plain_data_becomes_attributes_and_comes_back_unchanged():
    plain = {"pose": {"x": 1.0, "tags": ["a", {"b": None}]}, "data": b"\x00", "ok": True}
    message = message_from(plain)
    assert message.pose.tags[1].b is None
    assert plain_from(message) == plain


def test_a_missing_field_names_the_nearest_one():
    with pytest.raises(AttributeError, match="no field 'succes'; did you mean 'success'"):
        _ = message_from({"success": True, "text": ""}).succes


def test_a_missing_field_of_a_message_without_fields_says_so():
    with pytest.raises(AttributeError, match="it has no fields"):
        _ = message_from({}).x


def test_a_stand_in_takes_fields_by_name_and_is_sent_as_plain_data():
    point: Any = stand_in("Point", "geometry_msgs.msg")
    assert plain_from([point(x=1.0, y=point(z=2))]) == [{"x": 1.0, "y": {"z": 2}}]


def test_a_stand_in_refuses_what_only_the_real_class_could_place():
    point: Any = stand_in("Point", "geometry_msgs.msg")
    with pytest.raises(TypeError, match=r"geometry_msgs\.msg\.Point cannot be imported here"):
        point(1.0, 2.0)


def test_a_low_level_value_has_all_fields_of_its_type_from_the_start():
    place: Any = low_level_type("Place", "x", "y")()
    place.x = 3
    assert plain_from(place) == {"x": 3, "y": None}


def test_objects_of_a_robot_framework_are_sent_by_their_public_fields():
    assert plain_from(RosMessage()) == {"header": {"seq": 1}, "x": 2.5}


def test_numpy_values_are_sent_as_numbers_and_lists():
    assert plain_from({"a": np.float32(0.5), "b": np.arange(3), "c": np.bool_(True)}) == {
        "a": 0.5,
        "b": [0, 1, 2],
        "c": True,
    }


def test_enumerations_are_sent_by_their_values():
    assert plain_from(Enum("Side", {"LEFT": 7})["LEFT"]) == 7


@pytest.mark.parametrize("value", [object(), len, int, lambda: 0, (item for item in [])])
def test_what_is_no_data_is_refused_with_its_type(value):
    with pytest.raises(TypeError, match="is no plain data"):
        plain_from(value)


def test_a_value_that_contains_itself_is_refused():
    loop: list[object] = []
    loop.append(loop)
    with pytest.raises(TypeError, match="nested too deeply"):
        plain_from(loop)


def test_texts_for_records_are_json_where_that_is_possible():
    assert [text_of(value) for value in (True, 1.5, math.nan, "a", None, Message(x=1))] == [
        "true",
        "1.5",
        "nan",
        '"a"',
        "null",
        '{"x":1}',
    ]
    assert text_of(len) == "<built-in function len>"
    assert text_of(10**5000) == "a value of type int"
