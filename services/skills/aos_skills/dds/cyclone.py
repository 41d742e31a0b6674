"""Cyclone DDS for asyncio, and ROS's types as its classes: the only files here that import cyclonedds.

Cyclone calls back on its own threads; a callback only wakes the event loop, which then takes what has come.
"""

import asyncio
import struct
import types as python_types
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from aos_protocol.errors import BusError, DeployError
from aos_runtime.distribution import pip_install
from aos_skills.ros.node import Qos as RosQos
from aos_skills.ros.types import Field, RosTypes
from aos_skills.ros2.wire import dds_type

try:
    from cyclonedds.builtin import (
        BuiltinDataReader,
        BuiltinTopicDcpsPublication,
        BuiltinTopicDcpsSubscription,
    )
    from cyclonedds.core import DDSException, Listener, Policy, Qos
    from cyclonedds.domain import Domain, DomainParticipant
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl import annotations as idl_annotations
    from cyclonedds.idl import types as idl
    from cyclonedds.pub import DataWriter
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration
except ImportError as error:  # pragma: no cover - the extra is not installed
    raise DeployError(
        "the adapter for DDS needs the package cyclonedds", code="AOS805", hint=f"Run {pip_install('dds')}"
    ) from error

HEADER = struct.Struct("<Qq")
"""The beginning of Cyclone's requests and replies: who asks, and the number of the question."""

_MAX_BLOCKING_S = 1
_TAKEN_AT_ONCE = 100
_ALIVE = 16

_BASIC: dict[str, Any] = {
    "bool": bool,
    "byte": idl.byte,
    "float32": idl.float32,
    "float64": idl.float64,
    **{
        f"{sign}int{bits}": getattr(idl, f"{sign}int{bits}") for sign in ("", "u") for bits in (8, 16, 32, 64)
    },
}


class Endpoint(NamedTuple):
    """A writer or a reader of anybody in the domain, by its topic and its type's name in DDS."""

    is_writer: bool
    topic: str
    type_name: str
    qos: RosQos


class Writer(NamedTuple):
    """Sends payloads, and says how many readers it has found."""

    send: Callable[[bytes], None]
    matched: Callable[[], int]


class Reader(NamedTuple):
    """Says how many writers it has found, and can be closed."""

    matched: Callable[[], int]
    close: Callable[[], None]


class Participant:
    """One participant of a domain. Belongs to the event loop that made it."""

    def __init__(self, domain: int, interface: str, peers: tuple[str, ...], types: RosTypes) -> None:
        self._loop = asyncio.get_running_loop()
        self._classes = _Classes(types)
        self._topics: dict[str, Topic] = {}
        self._entities: list[Any] = []
        self._listeners: dict[int, Listener] = {}
        self._is_closed = False
        self.endpoints: dict[Any, Endpoint] = {}
        self.changed: Callable[[], None] = lambda: None
        try:
            self._domain = Domain(domain, _configuration(interface, peers))
            self._participant = DomainParticipant(domain)
        except DDSException as error:
            message = f"DDS cannot be used on the network interface {interface}: {error}"
            hint = "See the names of interfaces with: ip link"
            raise BusError(message, code="AOS605", hint=hint) from error
        self._follow(BuiltinTopicDcpsPublication, is_writer=True)
        self._follow(BuiltinTopicDcpsSubscription, is_writer=False)

    def close(self) -> None:
        """Leaves the domain. Closing twice does nothing."""
        if self._is_closed:
            return
        self._is_closed = True
        # Cyclone leaves when the last object is collected, which may be never: others hold some.
        for entity in (*reversed(self._entities), self._participant, self._domain):
            entity.__del__()

    def writer(self, topic: str, type_name: str, qos: RosQos, *, has_header: bool = False) -> Writer:
        """Writes payloads of CDR with encapsulation, of a full ROS type, on a topic of DDS."""
        cls = self._classes.of(type_name, has_header)
        writer = DataWriter(self._participant, self._topic(topic, cls, qos), qos=_qos(qos))
        self._entities.append(writer)
        return Writer(
            lambda payload: writer.write(cls.deserialize(payload)),
            lambda: writer.get_publication_matched_status().current_count,
        )

    def reader(
        self,
        topic: str,
        type_name: str,
        take: Callable[[bytes], None],
        qos: RosQos,
        *,
        has_header: bool = False,
    ) -> Reader:
        """Has payloads taken on the event loop."""
        cls = self._classes.of(type_name, has_header)

        def on_data(reader: DataReader) -> None:
            while samples := reader.take(_TAKEN_AT_ONCE):
                for sample in samples:
                    if sample.sample_info.valid_data:
                        take(bytes(sample.serialize(use_version_2=False)))

        dds_topic = self._topic(topic, cls, qos)
        reader = self._reading(
            lambda listener: DataReader(self._participant, dds_topic, qos=_qos(qos), listener=listener),
            on_data,
        )

        def close() -> None:
            if reader in self._entities:
                self._entities.remove(reader)
                reader.__del__()
                del self._listeners[id(reader)]

        return Reader(lambda: reader.get_subscription_matched_status().current_count, close)

    def _topic(self, name: str, cls: type[IdlStruct], qos: RosQos) -> Topic:
        if name not in self._topics:
            self._topics[name] = Topic(self._participant, name, cls, qos=_qos(qos))
            self._entities.append(self._topics[name])
        return self._topics[name]

    def _reading(self, make: Callable[[Listener], Any], take: Callable[[Any], None]) -> Any:
        """A reader that is made with a listener, and whose data are taken on the event loop."""
        made: list[Any] = []

        def on_loop() -> None:
            # The listener may be called before the reader is made.
            if made and not self._is_closed:
                take(made[0])

        def on_data_available(_: Any) -> None:
            if not self._is_closed:
                self._loop.call_soon_threadsafe(on_loop)

        listener = Listener()
        listener.set_on_data_available(on_data_available)
        made.append(make(listener))
        self._entities.append(made[0])
        self._listeners[id(made[0])] = listener
        on_loop()
        return made[0]

    def _follow(self, builtin: Any, *, is_writer: bool) -> None:
        self._reading(
            lambda listener: BuiltinDataReader(self._participant, builtin, listener=listener),
            lambda reader: self._take_endpoints(reader, is_writer),
        )

    def _take_endpoints(self, reader: Any, is_writer: bool) -> None:
        while samples := reader.take(_TAKEN_AT_ONCE):
            for sample in samples:
                info = sample.sample_info
                if not info.valid_data or info.instance_state != _ALIVE:
                    self.endpoints.pop(info.instance_handle, None)
                else:
                    found = Endpoint(is_writer, sample.topic_name, sample.type_name, _ros_qos(sample.qos))
                    self.endpoints[info.instance_handle] = found
        self.changed()


class _Classes:
    """Cyclone's classes for ROS types, made from their fields."""

    def __init__(self, types: RosTypes) -> None:
        self._types = types
        self._made: dict[tuple[str, bool], type[IdlStruct]] = {}

    def of(self, type_name: str, has_header: bool) -> type[IdlStruct]:
        key = (type_name, has_header)
        if key not in self._made:
            fields = {one.name: self._annotation(one) for one in self._types.fields(type_name)}
            if has_header:
                fields = {"writer_guid": idl.uint64, "sequence_number": idl.int64, **fields}
            # DDS has no empty structures; ROS 2 fills them with one byte.
            self._made[key] = _made(
                dds_type(type_name),
                fields if self._types.fields(type_name) else {**fields, "filler": idl.uint8},
            )
        return self._made[key]

    def _annotation(self, field: Field) -> Any:
        if field.is_message:
            base: Any = self.of(field.base, has_header=False)
        elif field.base == "string":
            base = idl.bounded_str[field.text_bound] if field.text_bound else str
        else:
            base = _BASIC[field.base]
        if field.length is None:
            return base
        smallest, largest = field.length
        if smallest:
            return idl.array[base, largest]
        return idl.sequence[base, largest] if largest else idl.sequence[base]


def _made(name: str, fields: dict[str, Any]) -> type[IdlStruct]:
    def body(namespace: dict[str, Any]) -> None:
        namespace["__annotations__"] = fields

    cls = python_types.new_class(name.rpartition("::")[2], (IdlStruct,), {"typename": name}, body)
    made: type[IdlStruct] = idl_annotations.final(dataclass(cls))
    return made


def _qos(qos: RosQos) -> Qos:
    """ROS 2 sends in the first version of CDR, whatever DDS would choose."""
    reliability = Policy.Reliability.BestEffort
    if qos.is_reliable:
        reliability = Policy.Reliability.Reliable(duration(seconds=_MAX_BLOCKING_S))
    durability = Policy.Durability.TransientLocal if qos.is_transient_local else Policy.Durability.Volatile
    return Qos(
        reliability,
        durability,
        Policy.History.KeepLast(qos.depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
    )


def _ros_qos(qos: Qos) -> RosQos:
    history = qos[Policy.History]
    return RosQos(
        getattr(history, "depth", RosQos().depth),
        isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable),
        qos[Policy.Durability] == Policy.Durability.TransientLocal,
    )


def _configuration(interface: str, peers: tuple[str, ...]) -> str:
    """Multicast finds the others on a network; named peers, and those on this machine, are asked directly."""
    is_local = interface == "lo"
    addresses = (*peers, *(["127.0.0.1"] if is_local else []))
    asked = "".join(f'<Peer Address="{address}"/>' for address in addresses)
    return (
        '<CycloneDDS><Domain Id="any"><General><Interfaces>'
        f'<NetworkInterface name="{interface}" multicast="{"false" if is_local else "default"}"/>'
        "</Interfaces></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
        f"<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex><Peers>{asked}</Peers>"
        "</Discovery></Domain></CycloneDDS>"
    )
