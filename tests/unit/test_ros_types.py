import pytest
from places import DATA

pytest.importorskip("rosbags", reason="needs the extra `ros`")

from aos_protocol.errors import DeployError, SkillError
from aos_skills.ros.definitions import definitions_in, interface_name, messages_of
from aos_skills.ros.types import RosTypes

INTERFACES = DATA / "interfaces"

CUP = {
    "name": "blue",
    "state": 1,
    "rim": [{"x": 0.5, "y": 0.0, "z": -1.0}],
    "size": [1.0, 2.0, 0.5],
    "handles": [True, False],
}


@pytest.fixture(scope="module")
def types() -> RosTypes:
    return RosTypes("jazzy", [INTERFACES])


@pytest.mark.parametrize(
    ("name", "digits"),
    [
        # Both stand in the design document of rmw_zenoh.
        ("std_msgs/msg/String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"),
        (
            "example_interfaces/srv/AddTwoInts",
            "e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a",
        ),
    ],
)
def test_hashes_are_those_of_ros_2(types: RosTypes, name, digits):
    assert types.hash(name) == f"RIHS01_{digits}"


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("lab_msgs/msg/Cup", CUP),
        ("lab_msgs/msg/Shelf", {"cups": [CUP, CUP], "name": "high"}),
        ("lab_msgs/srv/pick_unknown_Request", {"cup": CUP, "yaw": 0.25}),
        ("std_srvs/srv/Trigger_Request", {}),
        ("std_srvs/srv/Trigger_Response", {"success": True, "message": "völlig"}),
        (
            "example_interfaces/action/Fibonacci_GetResult_Response",
            {"status": 4, "result": {"sequence": [0, 1]}},
        ),
    ],
)
def test_a_value_survives_its_encoding(types: RosTypes, name, value):
    assert types.decoded(name, types.encoded(name, value)) == value


def test_an_empty_request_is_one_byte_as_in_ros_2(types: RosTypes):
    assert types.encoded("std_srvs/srv/Trigger_Request", {}) == b"\x00\x01\x00\x00\x00"


def test_fields_that_are_left_out_are_zero(types: RosTypes):
    assert types.decoded("lab_msgs/msg/Cup", types.encoded("lab_msgs/msg/Cup", {})) == {
        "name": "",
        "state": 0,
        "rim": [],
        "size": [0.0, 0.0, 0.0],
        "handles": [],
    }


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({"colour": 1}, "lab_msgs/msg/Cup has no field colour"),
        ({"rim": [{"w": 1}]}, r"geometry_msgs/msg/Point has no field rim\[0\].w"),
        ({"state": 300}, "state is a uint8 and cannot be 300"),
        ({"state": 0.5}, "state is a uint8 and cannot be 0.5"),
        ({"name": 3}, "name is a string and cannot be 3"),
        ({"size": [1]}, "size holds exactly 3 values, not 1"),
        ({"rim": "x"}, "rim is a list and cannot be 'x'"),
        ({"rim": [3]}, r"rim\[0\] is a geometry_msgs/msg/Point and cannot be 3"),
    ],
)
def test_what_does_not_fit_is_said_with_its_place(types: RosTypes, value, message):
    with pytest.raises(SkillError, match=message):
        types.encoded("lab_msgs/msg/Cup", value)


@pytest.mark.parametrize(
    "payload", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00\xff\xff\xff\xff", b"x" * 40]
)
def test_bytes_that_are_no_such_message_are_an_error_and_not_a_crash(types: RosTypes, payload):
    with pytest.raises(SkillError, match="what came is no lab_msgs/msg/Cup") as raised:
        types.decoded("lab_msgs/msg/Cup", payload)
    assert raised.value.code == "AOS508"


def test_bounds_are_kept(types: RosTypes):
    with pytest.raises(SkillError, match="cups holds at most 2 values, not 3"):
        types.encoded("lab_msgs/msg/Shelf", {"cups": [CUP, CUP, CUP]})


def test_an_unknown_type_names_the_file_to_add(types: RosTypes):
    with pytest.raises(
        DeployError, match=r"Add the file nav2_msgs/action/Spin\.action to a folder"
    ) as raised:
        types.hash("nav2_msgs/action/Spin_SendGoal")
    assert raised.value.code == "AOS806"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("Cup[] cups\n", r"lab/msg/Cup, which .*Shelf\.msg uses, .*lab/msg/Cup\.msg"),
        ("(no definition)\n", r"Shelf\.msg is not an interface file of ROS"),
    ],
    ids=["it uses a type that nobody defines", "it is no interface"],
)
def test_what_is_wrong_with_a_file_is_an_error_with_its_path(tmp_path, text, told):
    (tmp_path / "lab" / "msg").mkdir(parents=True)
    (tmp_path / "lab" / "msg" / "Shelf.msg").write_text(text)
    with pytest.raises(DeployError, match=told):
        RosTypes("jazzy", [tmp_path]).hash("lab/msg/Shelf")


def test_an_unknown_distribution_is_an_error_that_lists_the_known():
    with pytest.raises(DeployError, match=r"'noetic' is not a distribution .*humble, .*jazzy"):
        RosTypes("noetic")


def test_files_are_found_in_packages_and_one_by_one(tmp_path):
    found = {str(name) for name in definitions_in([INTERFACES])}
    assert found >= {"lab_msgs/msg/Cup", "lab_msgs/srv/pick_unknown", "example_interfaces/action/Fibonacci"}
    loose = tmp_path / "lab_msgs" / "Cup.msg"
    loose.parent.mkdir()
    loose.write_text("string name\n")
    assert [str(name) for name in definitions_in([loose])] == ["lab_msgs/msg/Cup"]


def test_a_service_without_its_line_of_dashes_is_an_error():
    with pytest.raises(DeployError, match="has 1 sections instead of 2"):
        messages_of(interface_name("lab/Pick", "srv"), "string name\n")
