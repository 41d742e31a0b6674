"""The servers and publishers that the master knows, and whether they still run."""

from __future__ import annotations

import socket
import time
from urllib.parse import urlparse

import rosgraph
import rosservice

from aos_skills.ros1.child.interfaces import Channel

POLL_S = 0.25
CONNECT_S = 0.5


class Names:
    """Asks the master again and again: it tells nobody about services, and keeps those of nodes that died."""

    def __init__(self, channel: Channel, own_node: str) -> None:
        self._channel = channel
        self._own_node = own_node
        self._master = rosgraph.Master("/aos")
        self._types: dict[tuple[str, str], str] = {}
        self._said: dict[str, dict[str, str]] | None = None

    def follow(self) -> None:
        """Tells every change, for ever: types by the names of services, actions and topics."""
        while True:
            names = self._names()
            if names != self._said:
                self._said = names
                self._channel.send(event="names", **names)
            time.sleep(POLL_S)

    def _names(self) -> dict[str, dict[str, str]]:
        try:
            published, _, served = self._master.getSystemState()
            topic_types = dict(self._master.getTopicTypes())
        except Exception:  # Whatever it is, the master does not answer, and nobody can be found.
            return {"services": {}, "actions": {}, "topics": {}}
        alive: dict[str, bool] = {}
        topics = {}
        for name, nodes in published:
            if any(self._is_alive(node, alive) for node in nodes):
                topics[name] = topic_types.get(name, "*")
        services = {}
        for name, nodes in served:
            if any(self._is_alive(node, alive) for node in nodes):
                services[name] = self._service_type(name, nodes[0])
        actions = {}
        for name in topics:
            goal, _, last = name.rpartition("/")
            goal_type = topic_types.get(goal + "/goal", "")
            if last == "result" and goal_type.endswith("ActionGoal"):
                actions[goal] = goal_type[: -len("ActionGoal")]
        return {"services": services, "actions": actions, "topics": topics}

    def _is_alive(self, node: str, known: dict[str, bool]) -> bool:
        """Returns whether the node's own server can be reached."""
        if node == self._own_node:
            return True
        if node not in known:
            try:
                uri = urlparse(self._master.lookupNode(node))
                socket.create_connection((uri.hostname, uri.port), CONNECT_S).close()
                known[node] = True
            except Exception:
                known[node] = False
        return known[node]

    def _service_type(self, name: str, node: str) -> str:
        key = (name, node)
        if key not in self._types:
            try:
                found = rosservice.get_service_type(name)
            except rosservice.ROSServiceIOException:
                found = None
            if not found:
                return ""
            self._types[key] = found
        return self._types[key]
