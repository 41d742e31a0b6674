"""Messages about a number on the command line that is not taken: which numbers are, and one of them."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

_REFUSALS = (" is not a valid ", " is not in the range ")
_NUMBERS = {"int": "a whole number", "float": "a number"}


class NumbersToldCommand(TyperCommand):
    """A program of one command that says which numbers it takes."""

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        with _numbers_told():
            return super().make_context(*arguments, **options)


class NumbersToldGroup(TyperGroup):
    """A program whose commands, also those of groups below, say which numbers they take."""

    def invoke(self, ctx: Any) -> Any:
        with _numbers_told():
            return super().invoke(ctx)


@contextmanager
def _numbers_told() -> Iterator[None]:
    try:
        yield
    except typer.BadParameter as error:
        kind = getattr(error.param, "type", None)
        what = _NUMBERS.get(getattr(kind, "name", "").removesuffix(" range"))
        for refusal in _REFUSALS if what else ():
            given, found, _ = error.message.partition(refusal)
            if found:
                error.message = f"{given} is not {what}{_range(kind)}, such as {_example(error.param)}"
        raise


def _range(kind: Any) -> str:
    least, most = getattr(kind, "min", None), getattr(kind, "max", None)
    if least is not None and most is not None:
        return f" from {least} to {most}"
    if least is not None:
        return f" of at least {least}"
    return "" if most is None else f" of at most {most}"


def _example(param: Any) -> float:
    """Returns the option's own default, else half of a share, or 1, or the least number of its range."""
    if isinstance(param.default, (int, float)):
        return param.default
    least, most = getattr(param.type, "min", None), getattr(param.type, "max", None)
    return 0.5 if most == 1 else max(least or 1, 1)
