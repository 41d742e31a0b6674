"""The servers and publishers that the master knows, and whether they still run."""

from __future__ import annotations

import socket
import threading
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
        self._looking = threading.Lock()
        self._own_node = own_node
        self._master = rosgraph.Master("/aos")
        self._types: dict[tuple[str, str], str] = {}
        self._said: dict[str, dict[str, str]] | None = None
        self._nodes: dict[str, str] = {}

    def follow(self) -> None:
        """Tells every change, for ever: types by the names of services, actions and topics, and the nodes."""
        while True:
            self.look()
            time.sleep(POLL_S)

    def look(self) -> None:
        """Looks once, and tells what has changed."""
        with self._looking:
            names = self._names()
            if names != self._said:
                self._said = names
                self._channel.send(event="names", **names)

    def look_after_loss(self, service: str) -> None:
        """Looks once, and again where the service seems to be there still: the connections of a node that
        dies end one after the other."""
        self.look()
        if self._said is not None and service in self._said["services"]:
            time.sleep(POLL_S)
            self.look()

    def advice(self, name: str) -> str:
        """Returns what to do where the node of a service or an action does not answer."""
        node = self._nodes.get(name)
        return f"Look whether the node {node} runs (`rosnode ping {node}`), and at its log" if node else ""

    def _names(self) -> dict[str, dict[str, str]]:
        try:
            published, _, served = self._master.getSystemState()
            topic_types = dict(self._master.getTopicTypes())
        except Exception:  # Whatever it is, the master does not answer, and nobody can be found.
            return {"services": {}, "actions": {}, "topics": {}, "nodes": {}}
        alive: dict[str, bool] = {}
        topics = {}
        nodes_of = {}
        for name, nodes in published:
            living = [node for node in nodes if self._is_alive(node, alive)]
            if living:
                topics[name] = topic_types.get(name, "*")
                nodes_of[name.rpartition("/")[0] if name.endswith("/result") else name] = living[0]
        services = {}
        for name, nodes in served:
            if any(self._is_alive(node, alive) for node in nodes):
                services[name] = self._service_type(name, nodes[0])
                nodes_of[name] = nodes[0]
        actions = {}
        for name in topics:
            goal, _, last = name.rpartition("/")
            goal_type = topic_types.get(goal + "/goal", "")
            if last == "result" and goal_type.endswith("ActionGoal"):
                actions[goal] = goal_type[: -len("ActionGoal")]
        self._nodes.update(nodes_of)
        served = {name: nodes_of[name] for name in (*services, *actions)}
        return {"services": services, "actions": actions, "topics": topics, "nodes": served}

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
