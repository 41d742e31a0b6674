"""Fields under other names: the expressions that a deploy file gives for foreign paths.

The deploy file says which programs run, so what it says is trusted as they are.
"""

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.spelling import error_text
from aos_runtime.plain_data import MAX_DEPTH, check_depth

_KNOWN = {name: value for name, value in vars(math).items() if not name.startswith("_")}


def check_expression(text: str) -> str:
    """Returns the mistake in an expression, empty where there is none."""
    try:
        compile(text.strip(), "<deploy file>", "eval")
    except (SyntaxError, ValueError) as error:
        return error.msg if isinstance(error, SyntaxError) else str(error)
    return ""


def translated(expressions: Mapping[str, str] | None, fields: Mapping[str, Any], what: str) -> dict[str, Any]:
    """Each expression's value over the fields; the fields themselves where there are no expressions.

    SkillError AOS502 names the field that could not be computed; `what` says of what it is.
    """
    if expressions is None:
        return dict(fields)
    names = {name: _field(name, value, what) for name, value in fields.items()}
    values = {}
    for name, text in expressions.items():
        try:
            values[name] = _plain(eval(text.strip(), dict(_KNOWN), names), MAX_DEPTH)
        except Exception as error:
            known = ", ".join(sorted(fields)) or "none"
            raise SkillError(
                f"the field {name} of {what} cannot be computed by {text!r}: {error_text(error)}",
                hint=f"See `bind:` in the deploy file; the fields that come in are {known}",
            ) from error
    return values


def _field(name: str, value: Any, what: str) -> Any:
    try:
        return _namespace(value, MAX_DEPTH)
    except TypeError as error:
        hint = "Give it with fewer levels"
        raise SkillError(f"the field {name} of {what} cannot be read: {error}", hint=hint) from error


def _namespace(value: Any, depth: int) -> Any:
    """Mappings get attributes: `goal.x`."""
    check_depth(depth)
    if isinstance(value, Mapping):
        return SimpleNamespace(**{str(name): _namespace(item, depth - 1) for name, item in value.items()})
    return [_namespace(item, depth - 1) for item in value] if isinstance(value, list) else value


def _plain(value: Any, depth: int) -> Any:
    check_depth(depth)
    if isinstance(value, SimpleNamespace):
        return {name: _plain(item, depth - 1) for name, item in vars(value).items()}
    return [_plain(item, depth - 1) for item in value] if isinstance(value, list | tuple) else value
