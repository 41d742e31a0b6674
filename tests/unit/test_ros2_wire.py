import pytest

from aos_skills.ros.node import Qos
from aos_skills.ros2.wire import Attachment, Endpoint, Kind, data_key, endpoint_of, gid_of, qos_of, qos_text

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
ADD_HASH = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"

LISTENER = Endpoint(2, "aac3178e146ba6f1fc6e6a4085e77f21", 0, 0, Kind.NODE, "listener")
TALKER = Endpoint(
    2,
    "8b20917502ee955ac4476e0266340d5c",
    0,
    10,
    Kind.PUBLISHER,
    "talker",
    name="/chatter",
    type_name="std_msgs/msg/String",
    type_hash=STRING_HASH,
    qos=Qos(depth=7),
)
SERVER = TALKER._replace(
    kind=Kind.SERVER,
    node="add_two_ints_server",
    name="/add_two_ints",
    type_name="example_interfaces/srv/AddTwoInts",
    type_hash=ADD_HASH,
    qos=Qos(),
)


@pytest.mark.parametrize(
    ("endpoint", "token"),
    [
        (LISTENER, "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"),
        (
            TALKER,
            "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/"
            f"std_msgs::msg::dds_::String_/{STRING_HASH}/::,7:,:,:,,",
        ),
        (
            SERVER,
            "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
            f"example_interfaces::srv::dds_::AddTwoInts_/{ADD_HASH}/::,10:,:,:,,",
        ),
    ],
)
def test_tokens_are_as_in_the_design_document(endpoint, token):
    assert endpoint.token == token
    assert endpoint_of(token) == endpoint


def test_keys_are_as_in_the_design_document():
    key = data_key(0, "/robot1/chatter", "std_msgs/msg/String", STRING_HASH)
    assert key == f"0/robot1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"
    assert SERVER.key == f"2/add_two_ints/example_interfaces::srv::dds_::AddTwoInts_/{ADD_HASH}"


def test_namespaces_survive_the_token():
    endpoint = TALKER._replace(namespace="/lab/robot1", name="/lab/robot1/chatter", enclave="/a/b")
    assert endpoint_of(endpoint.token) == endpoint


@pytest.mark.parametrize("qos", [Qos(), Qos(1, True, True), Qos(5, False, False)])
def test_qualities_of_service_survive_their_text(qos):
    assert qos_of(qos_text(qos)) == qos


@pytest.mark.parametrize(
    "token",
    [
        "",
        "aos/robot/live/solver",
        "@ros2_lv/0/abc/NN/_/talker",  # as it was before Zenoh 1.0
        "@ros2_lv/x/abc/0/0/NN/%/%/talker",
        "@ros2_lv/0/abc/0/0/XX/%/%/talker",
        "@ros2_lv/0/abc/0/10/MP/%/%/talker",
    ],
)
def test_tokens_of_another_form_are_left_alone(token):
    assert endpoint_of(token) is None


def test_attachments_are_33_bytes_little_endian():
    attachment = Attachment(258, 1, gid_of(TALKER.token))
    data = attachment.encoded()
    assert data[:17] == b"\x02\x01" + bytes(6) + b"\x01" + bytes(7) + b"\x10"
    assert len(data) == 33
    assert Attachment.read(data) == attachment


@pytest.mark.parametrize("data", [b"", bytes(32), bytes(33), b"\x0fsequence_number" + bytes(60)])
def test_attachments_of_older_releases_are_not_misread(data):
    assert Attachment.read(data) is None
