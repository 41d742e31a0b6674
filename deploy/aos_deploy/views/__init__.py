"""The views of a mission: the live view, plain lines, or JSON lines.

A view takes the events of `events` by calling it, and is a context manager around the time it is shown.
"""

from contextlib import AbstractContextManager
from typing import Protocol, Self

from aos_deploy.events import Event

__all__ = ["View", "make_view"]


class View(AbstractContextManager["View"], Protocol):
    """Shows events as they come."""

    def __call__(self, event: Event) -> None: ...

    def __enter__(self) -> Self: ...


def make_view(title: str, *, is_plain: bool, is_json: bool, is_terminal: bool) -> View:
    """The view that fits: live on a terminal, plain lines elsewhere or if asked for."""
    from aos_deploy.views.lines import JsonView, PlainView

    if is_json:
        return JsonView()
    if is_plain or not is_terminal:
        return PlainView()
    from aos_deploy.views.live import LiveView

    return LiveView(title)
