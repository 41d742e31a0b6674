"""The form of ROS 2 on Zenoh by rmw_zenoh: keys, liveliness tokens, quality of service, attachments.

The form is the one that its design document describes since version 0.2.4 (2025): key expressions end with
the type's name and hash, tokens stand under `@ros2_lv`, attachments have no labels.
"""

from __future__ import annotations

import hashlib
import struct
from enum import StrEnum
from typing import NamedTuple

from aos_skills.ros.node import DEFAULT_QOS, Qos


class Kind(StrEnum):
    """The kinds of things that a token stands for."""

    NODE = "NN"
    PUBLISHER = "MP"
    SUBSCRIPTION = "MS"
    SERVER = "SS"
    CLIENT = "SC"


def qos_text(qos: Qos) -> str:
    """Writes it as it stands in a token; an empty part means the default."""
    reliability = "" if qos.is_reliable else "2"
    durability = "1" if qos.is_transient_local else ""
    return f"{reliability}:{durability}:,{qos.depth}:,:,:,,"


def qos_of(text: str) -> Qos:
    """Reads it from a token; what cannot be read is the default."""
    parts = [*text.split(":"), "", "", ""]
    depth = parts[2].partition(",")[2]
    return Qos(int(depth) if depth.isdigit() else DEFAULT_QOS.depth, parts[0] != "2", parts[1] == "1")


class Endpoint(NamedTuple):
    """A node, or one of its publishers, subscriptions, servers or clients.

    `name` is the full name of the topic or service, `/robot1/chatter`; `type_name` is as ROS 2 writes it,
    `std_msgs/msg/String`. Both are empty for a node.
    """

    domain: int
    session: str
    node_number: int
    number: int
    kind: Kind
    node: str
    namespace: str = "/"
    enclave: str = "/"
    name: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: Qos = DEFAULT_QOS

    @property
    def token(self) -> str:
        """The liveliness token's key."""
        parts = [
            f"@ros2_lv/{self.domain}/{self.session}/{self.node_number}/{self.number}/{self.kind}",
            _mangled(self.enclave),
            _mangled(self.namespace),
            self.node,
        ]
        if self.kind is not Kind.NODE:
            parts += [_mangled(self.name), dds_type(self.type_name), self.type_hash, qos_text(self.qos)]
        return "/".join(parts)

    @property
    def key(self) -> str:
        """The key under which the data of the topic or service go."""
        return data_key(self.domain, self.name, self.type_name, self.type_hash)


def endpoint_of(token: str) -> Endpoint | None:
    """Returns what a token stands for; None for one that is not in this form."""
    parts = token.split("/")
    if len(parts) not in (9, 13) or parts[0] != "@ros2_lv" or parts[5] not in list(Kind):
        return None
    kind = Kind(parts[5])
    if (kind is Kind.NODE) is not (len(parts) == 9) or not all(parts[at].isdigit() for at in (1, 3, 4)):
        return None
    endpoint = Endpoint(
        domain=int(parts[1]),
        session=parts[2],
        node_number=int(parts[3]),
        number=int(parts[4]),
        kind=kind,
        node=parts[8],
        namespace=_plain(parts[7]),
        enclave=_plain(parts[6]),
    )
    if kind is Kind.NODE:
        return endpoint
    return endpoint._replace(
        name=_plain(parts[9]), type_name=ros_type(parts[10]), type_hash=parts[11], qos=qos_of(parts[12])
    )


def data_key(domain: int, name: str, type_name: str, type_hash: str) -> str:
    """The key expression of a topic or a service."""
    return f"{domain}/{name.strip('/')}/{dds_type(type_name)}/{type_hash}"


def dds_type(type_name: str) -> str:
    """`std_msgs/msg/String` as DDS calls it: `std_msgs::msg::dds_::String_`."""
    package, kind, name = type_name.split("/")
    return f"{package}::{kind}::dds_::{name}_"


def ros_type(dds_name: str) -> str:
    """The reverse of `dds_type`; a name of another form stays as it is."""
    return dds_name.removesuffix("_").replace("::dds_::", "::").replace("::", "/")


def _mangled(name: str) -> str:
    return name.replace("/", "%")


def _plain(mangled: str) -> str:
    return mangled.replace("%", "/")


class Attachment(NamedTuple):
    """The bytes beside each payload: who sent it, when, and its number."""

    number: int
    sent_ns: int
    gid: bytes

    def encoded(self) -> bytes:
        return struct.pack("<qqB", self.number, self.sent_ns, len(self.gid)) + self.gid

    @classmethod
    def read(cls, data: bytes) -> Attachment | None:
        """Reads it from bytes; None if it is not in this form, as those of releases before 0.2.4."""
        if len(data) != 33 or data[16] != 16:
            return None
        number, sent_ns, _ = struct.unpack_from("<qqB", data)
        return cls(number, sent_ns, data[17:])


def gid_of(token: str) -> bytes:
    """The 16 bytes that tell an endpoint from all others. ROS 2 compares them and reads nothing in them."""
    return hashlib.md5(token.encode(), usedforsecurity=False).digest()
