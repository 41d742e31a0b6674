"""The router's access control, made of the table in `aos_protocol.access`, in Zenoh's words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from aos_protocol.access import Act, Party, grants

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
