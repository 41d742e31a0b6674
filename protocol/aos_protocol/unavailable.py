"""Reasons why skills cannot be run, as people read them: what several have in common is told once."""

from collections.abc import Iterable, Mapping

NO_ADAPTER = "no adapter answers calls of "
"""The beginning of the reason for a path that nobody serves; the path follows."""


def told_together(reasons: Iterable[str], *, after: str = "") -> str:
    """Each reason once, in order, and the paths that nobody serves for one reason together.

    What the text `after` tells is left out; where it tells what an adapter says, the path alone is told.
    """
    others = [reason for reason in reasons if reason not in after]
    return "; ".join(by_reason({reason: _shortened(reason, after) for reason in others}))


def _shortened(reason: str, after: str) -> str:
    path, said = _path_and_said(reason)
    return f"{NO_ADAPTER}{path}: for the same reason" if said and said in after else reason


def by_reason(unavailable: Mapping[str, str]) -> dict[str, list[str]]:
    """Returns the skills of each reason, in order; a reason names all paths that nobody serves for it."""
    paths: dict[str, list[str]] = {}
    for reason in dict.fromkeys(unavailable.values()):
        path, said = _path_and_said(reason)
        if path:
            paths.setdefault(said, []).append(path)
    skills: dict[str, list[str]] = {}
    for skill, reason in unavailable.items():
        path, said = _path_and_said(reason)
        together = f"{NO_ADAPTER}{', '.join(paths[said])}{said}" if path else reason
        skills.setdefault(together, []).append(skill)
    return skills


def _path_and_said(reason: str) -> tuple[str, str]:
    """The path that nobody serves, and with a colon before it what adapters say of that; "" if it is none."""
    if not reason.startswith(NO_ADAPTER):
        return "", ""
    path, colon, said = reason.removeprefix(NO_ADAPTER).partition(": ")
    return path, colon + said
