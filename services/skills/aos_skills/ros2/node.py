"""A ROS 2 node without ROS: topics and services as rmw_zenoh speaks them. Values are dicts of fields."""

from __future__ import annotations

import asyncio
import itertools
import time
from collections.abc import Awaitable, Callable
from typing import Self

from aos_protocol.errors import BusError, LateAnswerError, NobodyAnswersError, SkillError
from aos_runtime.bus.foreign_bus import ForeignBus, Packet, Undo
from aos_skills.ros.faults import check_type, node_lost, not_answered, not_served
from aos_skills.ros.node import DEFAULT_QOS, Fields, Qos, ServiceRequest, TopicFound
from aos_skills.ros.ros2_node import Ros2Node
from aos_skills.ros.types import NO_HASH, RosTypes
from aos_skills.ros2.wire import Attachment, Endpoint, Kind, endpoint_of, gid_of

_FIRST_ENTITY = 10


class Node(Ros2Node):
    """Belongs to the event loop that opened it."""

    def __init__(self, bus: ForeignBus, types: RosTypes, name: str, domain: int) -> None:
        super().__init__(types)
        self.domain = domain
        self._bus = bus
        self._node = Endpoint(domain, bus.id, 0, 0, Kind.NODE, name)
        self._numbers = itertools.count(_FIRST_ENTITY)
        self._clients: dict[str, _Client] = {}
        bus.announce(self._node.token)
        self.graph = Graph(bus, domain)

    @classmethod
    async def open(
        cls, endpoint: str, types: RosTypes, *, name: str, domain: int = 0, connect_timeout_s: float = 5.0
    ) -> Self:
        """Joins the ROS 2 system whose router is at `endpoint`; BusError AOS605 if there is none."""
        bus = await ForeignBus.open(endpoint, connect_timeout_s=connect_timeout_s)
        return cls(bus, types, name, domain)

    async def close(self) -> None:
        await self.unended.close()
        await self._bus.close()

    # --- topics ---

    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT_QOS) -> Callable[[Fields], None]:
        own = self._endpoint(Kind.PUBLISHER, topic, type_name, self.types.hash(type_name), qos)
        send = self._bus.publisher(own.key, cached=qos.depth if qos.is_transient_local else 0)
        self._bus.announce(own.token)
        gid, numbers = gid_of(own.token), itertools.count(1)

        def publish(fields: Fields) -> None:
            attachment = Attachment(next(numbers), time.time_ns(), gid).encoded()
            send(Packet(self.types.encoded(type_name, fields), attachment))

        return publish

    def subscribe(
        self, topic: str, type_name: str, take: Callable[[Fields], None], qos: Qos = DEFAULT_QOS
    ) -> Undo:
        own = self._endpoint(Kind.SUBSCRIPTION, topic, type_name, self._hash(topic, type_name), qos)

        on_payload = self._decoding(topic, type_name, take)
        stop = self._bus.listen(
            own.key, lambda packet: on_payload(packet.payload), with_history=qos.is_transient_local
        )
        leave = self._bus.announce(own.token)

        def undo() -> None:
            leave()
            stop()

        return undo

    async def until_heard(self, topic: str) -> None:
        """A router knows of a subscription before it hears of a goal from the same session."""

    async def topic(self, topic: str, timeout_s: float) -> TopicFound | None:
        publisher = await self.graph.wait_for(Kind.PUBLISHER, topic, timeout_s)
        return None if publisher is None else TopicFound(publisher.type_name, publisher.qos)

    # --- services ---

    async def call(self, request: ServiceRequest) -> Fields:
        found_within_s = min(request.discovery_s, request.timeout_s)
        server = await self._server(request.service, request.type_name, found_within_s)
        client = self._client(server)
        encoded = self.types.encoded(f"{server.type_name}_Request", request.fields)
        try:
            packet = Packet(encoded, client.attachment())
            answer = await self._bus.ask(server.key, packet, timeout_s=request.timeout_s)
        except BusError as error:
            raise _skill_error(request.service, request.timeout_s, error) from error
        return self.types.decoded(f"{server.type_name}_Response", answer.payload)

    async def service_type(self, service: str, type_name: str, timeout_s: float) -> str:
        return (await self._server(service, type_name, timeout_s)).type_name

    async def _server(self, service: str, type_name: str, timeout_s: float) -> Endpoint:
        """The node's end of a service, whose type is as it is defined here."""
        server = await self.graph.wait_for(Kind.SERVER, service, timeout_s)
        if server is None:
            raise not_served(f"no ROS 2 node serves {service} in domain {self.domain}", self.services())
        check_type(service, server.type_name, type_name)
        self._same_definition(server)
        return server

    def serve(self, service: str, type_name: str, handler: Callable[[Fields], Awaitable[Fields]]) -> None:
        own = self._endpoint(Kind.SERVER, service, type_name, self.types.hash(type_name), DEFAULT_QOS)

        async def on_request(packet: Packet) -> Packet:
            asked = Attachment.read(packet.attachment)
            response = await handler(self.types.decoded(f"{type_name}_Request", packet.payload))
            attachment = b"" if asked is None else asked._replace(sent_ns=time.time_ns()).encoded()
            return Packet(self.types.encoded(f"{type_name}_Response", response), attachment)

        self._bus.answer(own.key, on_request)
        # Whoever sees the token may ask at once.
        self._bus.announce(own.token)

    async def changed(self) -> None:
        await self.graph.changed()

    # --- what they share ---

    def services(self) -> list[str]:
        return sorted(self.graph.names(Kind.SERVER))

    def serves(self, service: str) -> bool:
        return bool(self.graph.find(Kind.SERVER, service))

    def node_of(self, name: str) -> str:
        for service in (name, f"{name}/_action/send_goal"):
            for server in self.graph.find(Kind.SERVER, service):
                return server.node
        return ""

    def _client(self, server: Endpoint) -> _Client:
        if server.key not in self._clients:
            own = self._endpoint(Kind.CLIENT, server.name, server.type_name, server.type_hash, DEFAULT_QOS)
            self._bus.announce(own.token)
            self._clients[server.key] = _Client(gid_of(own.token))
        return self._clients[server.key]

    def _endpoint(self, kind: Kind, name: str, type_name: str, type_hash: str, qos: Qos) -> Endpoint:
        endpoint = self._node._replace(
            number=next(self._numbers),
            kind=kind,
            name=name,
            type_name=type_name,
            type_hash=type_hash,
            qos=qos,
        )
        return endpoint

    def _hash(self, topic: str, type_name: str) -> str:
        """The hash that the topic's publisher uses, if there is one already."""
        for publisher in self.graph.find(Kind.PUBLISHER, topic):
            if publisher.type_name == type_name:
                self._same_definition(publisher)
                return publisher.type_hash
        return self.types.hash(type_name)

    def _same_definition(self, theirs: Endpoint) -> None:
        """Raises SkillError AOS509 unless a node's type is defined as here."""
        own = self.types.hash(theirs.type_name)
        if NO_HASH not in (theirs.type_hash, own) and theirs.type_hash != own:
            raise SkillError(
                f"the node {theirs.node} defines {theirs.type_name} of {theirs.name} differently from here",
                code="AOS509",
                hint="Give the interface files that the node was built with, "
                "and its ROS distribution (humble, jazzy, ...)",
            )


class _Client:
    """The mark that tells one service client's requests from all others."""

    def __init__(self, gid: bytes) -> None:
        self._gid = gid
        self._numbers = itertools.count(1)

    def attachment(self) -> bytes:
        return Attachment(next(self._numbers), time.time_ns(), self._gid).encoded()


def _skill_error(service: str, timeout_s: float, error: BusError) -> SkillError:
    if isinstance(error, LateAnswerError):
        return not_answered(service, timeout_s)
    if isinstance(error, NobodyAnswersError):
        return node_lost(service)
    return SkillError(error.message, hint=error.hint)


class Graph:
    """Follows who comes and goes. Names are full, with a leading slash."""

    def __init__(self, bus: ForeignBus, domain: int) -> None:
        self._endpoints: dict[str, Endpoint] = {}
        self._has_changed = asyncio.Event()
        bus.watch(f"@ros2_lv/{domain}/**", self._on_change)

    def _on_change(self, token: str, is_present: bool) -> None:
        endpoint = endpoint_of(token)
        if endpoint is None:
            return
        if is_present:
            self._endpoints[token] = endpoint
        else:
            self._endpoints.pop(token, None)
        self._has_changed.set()

    def find(self, kind: Kind, name: str) -> list[Endpoint]:
        return [one for one in self._endpoints.values() if one.kind is kind and one.name == name]

    def names(self, kind: Kind) -> dict[str, str]:
        """The names of all topics or services with endpoints of a kind, and their types."""
        return {one.name: one.type_name for one in self._endpoints.values() if one.kind is kind}

    async def changed(self) -> None:
        self._has_changed.clear()
        await self._has_changed.wait()

    async def wait_for(self, kind: Kind, name: str, timeout_s: float) -> Endpoint | None:
        """The first endpoint of that kind and name; None if none comes in time."""
        try:
            async with asyncio.timeout(timeout_s):
                while not (found := self.find(kind, name)):
                    await self.changed()
        except TimeoutError:
            return None
        return found[0]
