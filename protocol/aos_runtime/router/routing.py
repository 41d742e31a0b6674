"""The bus router as a service.

Its access control is the table in `aos_protocol.access`, in Zenoh's words. The settings are those of every
service; `endpoint` is where it listens.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import zenoh

from aos_protocol.access import Act, Party, grants
from aos_protocol.errors import BusError
from aos_runtime.bus.config import router_config
from aos_runtime.processes.settings import ServiceSettings
from aos_runtime.router.log import refusals_logged

_log = logging.getLogger("aos.router")


class RouterSettings(ServiceSettings, frozen=True, kw_only=True):
    """`dictionary` has the names and passwords of the `parties`, a line for each.

    It is removed once it is read. Without one, everybody may do everything. At `ros2` nodes of ROS 2 meet: a
    router for them alone, which shares nothing with the bus.
    """

    dictionary: str = ""
    parties: tuple[Party, ...] = ()
    ros2: str = ""


async def route(settings: RouterSettings) -> None:
    """Routes until cancelled. BusError AOS605 if an endpoint cannot be listened on, or passwords are
    missing."""
    dictionary = Path(settings.dictionary) if settings.dictionary else None
    with ExitStack() as stack:
        access = None
        if dictionary is not None:
            access = access_control(settings.robot, settings.parties)
            stack.enter_context(refusals_logged(zenoh.init_log_from_env_or))
        try:
            config = router_config(settings.endpoint, access=access, dictionary=dictionary)
            stack.enter_context(_listening(config, settings.endpoint))
        finally:
            if dictionary is not None:
                dictionary.unlink(missing_ok=True)
        if settings.ros2:
            stack.enter_context(_listening(router_config(settings.ros2), settings.ros2))
        await asyncio.get_running_loop().create_future()


def _listening(config: zenoh.Config, endpoint: str) -> zenoh.Session:
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        message = f"the router cannot listen at {endpoint}: {error}"
        hint = "Another program listens there? Give another endpoint, or port 0 for any free one"
        raise BusError(message, code="AOS605", hint=hint) from error
    _log.info("listening at %s", endpoint)
    return session


_MESSAGES: dict[Act, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "asks": (("query",), ("reply", "declare_queryable")),
    "answers": (("declare_queryable", "reply"), ("query",)),
    "tells": (("put",), ("declare_subscriber",)),
    "hears": (("declare_subscriber",), ("put",)),
    "announces": (("liveliness_token",), ()),
    "watches": (("declare_liveliness_subscriber", "liveliness_query"), ("liveliness_token",)),
}
"""The messages that a party may send for each act, and those that it may be sent."""


def access_control(robot: str, parties: Iterable[Party]) -> dict[str, Any]:
    """Zenoh's `access_control`: each party, known by its user name, has its grants. Nobody else has any."""
    rules: list[dict[str, Any]] = []
    subjects, policies = [], []
    for party in parties:
        own = _rules(robot, party)
        rules += own
        subjects.append({"id": party.name, "usernames": [party.name]})
        policies.append({"rules": [rule["id"] for rule in own], "subjects": [party.name]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rules(robot: str, party: Party) -> list[dict[str, Any]]:
    """One rule for each act, direction and permission that the party has."""
    keys: dict[tuple[Act, bool], list[str]] = {}
    for grant in grants(robot, party):
        keys.setdefault((grant.act, grant.is_denied), []).append(grant.key)
    return [
        {
            "id": f"{party.name} {act} {flow}{' not' if is_denied else ''}",
            "permission": "deny" if is_denied else "allow",
            "messages": list(messages),
            "flows": [flow],
            "key_exprs": expressions,
        }
        for (act, is_denied), expressions in keys.items()
        for flow, messages in zip(("ingress", "egress"), _MESSAGES[act], strict=True)
        if messages
    ]
