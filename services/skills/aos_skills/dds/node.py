"""A ROS 2 node over DDS: topics of any vendor, services and actions of robots that run Cyclone DDS."""

import asyncio
import itertools
import logging
import secrets
from collections.abc import Awaitable, Callable

from aos_runtime.background import Background
from aos_skills.dds.cyclone import HEADER, Endpoint, Participant, Writer
from aos_skills.ros.faults import check_type, not_answered, not_served
from aos_skills.ros.node import DEFAULT_QOS, Fields, Qos, ServiceRequest, TopicFound
from aos_skills.ros.ros2_node import Ros2Node
from aos_skills.ros.types import RosTypes
from aos_skills.ros2.wire import ros_type

_CDR = b"\x00\x01\x00\x00"
_MATCH_POLL_S = 0.01
_MATCH_S = 1.0

_log = logging.getLogger("aos.dds")


class DdsNode(Ros2Node):
    """Belongs to the event loop that made it."""

    def __init__(
        self, types: RosTypes, *, domain: int = 0, interface: str = "lo", peers: tuple[str, ...] = ()
    ) -> None:
        super().__init__(types)
        self._domain = domain
        self._participant = Participant(domain, interface, peers, types)
        self._participant.changed = self._on_change
        self._has_changed = asyncio.Event()
        self._clients: dict[str, _Client] = {}
        self._matched: dict[str, Callable[[], int]] = {}
        self._answering = Background()

    async def close(self) -> None:
        await self.unended.close()
        await self._answering.cancel()
        self._clients.clear()
        self._participant.close()

    # --- topics ---

    def publisher(self, topic: str, type_name: str, qos: Qos = DEFAULT_QOS) -> Callable[[Fields], None]:
        writer = self._participant.writer(f"rt{topic}", type_name, qos)
        return lambda fields: writer.send(self.types.encoded(type_name, fields))

    def subscribe(
        self, topic: str, type_name: str, take: Callable[[Fields], None], qos: Qos = DEFAULT_QOS
    ) -> Callable[[], None]:
        on_payload = self._decoding(topic, type_name, take)
        reader = self._participant.reader(f"rt{topic}", type_name, on_payload, qos)
        self._matched[topic] = reader.matched
        return reader.close

    async def until_heard(self, topic: str) -> None:
        await _until(lambda: self._matched[topic]() > 0)

    async def topic(self, topic: str, timeout_s: float) -> TopicFound | None:
        found = await self._wait_for(True, f"rt{topic}", timeout_s)
        return None if found is None else TopicFound(ros_type(found.type_name), found.qos)

    # --- services ---

    async def call(self, request: ServiceRequest) -> Fields:
        service, timeout_s = request.service, request.timeout_s
        type_name = await self.service_type(service, request.type_name, min(request.discovery_s, timeout_s))
        if service not in self._clients:
            self._clients[service] = _Client(self._participant, service, type_name)
        encoded = self.types.encoded(f"{type_name}_Request", request.fields)
        try:
            async with asyncio.timeout(timeout_s):
                response = await self._clients[service].ask(encoded)
        except TimeoutError as error:
            raise not_answered(service, timeout_s) from error
        return self.types.decoded(f"{type_name}_Response", response)

    async def service_type(self, service: str, type_name: str, timeout_s: float) -> str:
        found = await self._wait_for(False, f"rq{service}Request", timeout_s)
        if found is None:
            raise not_served(
                f"no ROS 2 node serves {service} in domain {self._domain} of DDS", self.services()
            )
        theirs = ros_type(found.type_name).removesuffix("_Request")
        check_type(service, theirs, type_name)
        self.types.check(f"{theirs}_Request")
        return theirs

    def serve(self, service: str, type_name: str, handler: Callable[[Fields], Awaitable[Fields]]) -> None:
        async def answer(payload: bytes) -> None:
            head, body = _split(payload)
            try:
                response = await handler(self.types.decoded(f"{type_name}_Request", body))
                encoded = self.types.encoded(f"{type_name}_Response", response)
            except Exception as error:
                _log.warning("%s is not answered: %s", service, error)
            else:
                await _until(lambda: replies.matched() > 0)
                replies.send(_joined(head, encoded))

        def on_request(payload: bytes) -> None:
            self._answering.begin(answer(payload))

        replies = self._participant.writer(
            f"rr{service}Reply", f"{type_name}_Response", DEFAULT_QOS, has_header=True
        )
        self._participant.reader(
            f"rq{service}Request", f"{type_name}_Request", on_request, DEFAULT_QOS, has_header=True
        )

    # --- who is there ---

    def _on_change(self) -> None:
        self._has_changed.set()

    async def changed(self) -> None:
        self._has_changed.clear()
        await self._has_changed.wait()

    def serves(self, service: str) -> bool:
        return self._find(False, f"rq{service}Request") is not None

    def _find(self, is_writer: bool, topic: str) -> Endpoint | None:
        known = self._participant.endpoints.values()
        return next((one for one in known if one.is_writer is is_writer and one.topic == topic), None)

    async def _wait_for(self, is_writer: bool, topic: str, timeout_s: float) -> Endpoint | None:
        try:
            async with asyncio.timeout(timeout_s):
                while (found := self._find(is_writer, topic)) is None:
                    await self.changed()
        except TimeoutError:
            return None
        return found

    def services(self) -> list[str]:
        topics = {one.topic for one in self._participant.endpoints.values() if not one.is_writer}
        return sorted(
            topic.removeprefix("rq").removesuffix("Request") for topic in topics if topic.startswith("rq/")
        )


class _Client:
    """Questions to one service, told apart by this client's number and theirs."""

    def __init__(self, participant: Participant, service: str, type_name: str) -> None:
        self._id = secrets.randbits(64)
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[bytes]] = {}
        self._requests: Writer = participant.writer(
            f"rq{service}Request", f"{type_name}_Request", DEFAULT_QOS, has_header=True
        )
        self._replies = participant.reader(
            f"rr{service}Reply", f"{type_name}_Response", self._on_reply, DEFAULT_QOS, has_header=True
        )

    async def ask(self, request: bytes) -> bytes:
        # A request that is sent before both sides have found each other is lost.
        while not (self._requests.matched() and self._replies.matched()):  # noqa: ASYNC110
            await asyncio.sleep(_MATCH_POLL_S)
        number = next(self._numbers)
        answer: asyncio.Future[bytes] = asyncio.get_running_loop().create_future()
        self._waiting[number] = answer
        self._requests.send(_joined(HEADER.pack(self._id, number), request))
        try:
            return await answer
        finally:
            del self._waiting[number]

    def _on_reply(self, payload: bytes) -> None:
        head, body = _split(payload)
        asked_by, number = HEADER.unpack(head)
        waiting = self._waiting.get(number)
        if asked_by == self._id and waiting is not None and not waiting.done():
            waiting.set_result(body)


async def _until(is_matched: Callable[[], bool]) -> None:
    """Returns when the other side is known, without which what is sent is lost; after a while in any case."""
    ends_at_s = asyncio.get_running_loop().time() + _MATCH_S
    while not is_matched() and asyncio.get_running_loop().time() < ends_at_s:  # noqa: ASYNC110
        await asyncio.sleep(_MATCH_POLL_S)


def _joined(head: bytes, payload: bytes) -> bytes:
    """A header before the fields. Sixteen bytes change no alignment."""
    return payload[: len(_CDR)] + head + payload[len(_CDR) :]


def _split(payload: bytes) -> tuple[bytes, bytes]:
    start = len(_CDR) + HEADER.size
    return payload[len(_CDR) : start], payload[: len(_CDR)] + payload[start:]
