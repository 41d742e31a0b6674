"""Reasons why skills cannot be run, as people read them: what several have in common is told once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

NO_ADAPTER = "no adapter answers calls of "
"""The beginning of the reason for a path that nobody serves; the path follows."""


def told_together(reasons: Iterable[str]) -> str:
    """Each reason once, in order, and the paths that nobody serves as one of them."""
    return "; ".join(by_reason({reason: reason for reason in reasons}))


def by_reason(unavailable: Mapping[str, str]) -> dict[str, list[str]]:
    """Returns the skills of each reason, in order; a reason names all paths that nobody serves."""
    plain = [
        reason
        for reason in dict.fromkeys(unavailable.values())
        if reason.startswith(NO_ADAPTER) and ": " not in reason
    ]
    paths = NO_ADAPTER + ", ".join(reason.removeprefix(NO_ADAPTER) for reason in plain)
    skills: dict[str, list[str]] = {}
    for skill, reason in unavailable.items():
        skills.setdefault(paths if reason in plain else reason, []).append(skill)
    return skills
