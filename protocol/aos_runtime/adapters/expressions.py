"""Fields under other names: the expressions that a deploy file gives for foreign paths.

The deploy file says which programs run, so what it says is trusted as they are.
"""

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

from aos_protocol.errors import SkillError
from aos_protocol.spelling import error_text

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
    names = {name: _namespace(value) for name, value in fields.items()}
    values = {}
    for name, text in expressions.items():
        try:
            values[name] = _plain(eval(text.strip(), dict(_KNOWN), names))
        except Exception as error:
            known = ", ".join(sorted(fields)) or "none"
            raise SkillError(
                f"the field {name} of {what} cannot be computed by {text!r}: {error_text(error)}",
                hint=f"See `bind:` in the deploy file; the fields that come in are {known}",
            ) from error
    return values


def _namespace(value: Any) -> Any:
    """Mappings get attributes: `goal.x`."""
    if isinstance(value, Mapping):
        return SimpleNamespace(**{str(name): _namespace(item) for name, item in value.items()})
    return [_namespace(item) for item in value] if isinstance(value, list) else value


def _plain(value: Any) -> Any:
    if isinstance(value, SimpleNamespace):
        return {name: _plain(item) for name, item in vars(value).items()}
    return [_plain(item) for item in value] if isinstance(value, list | tuple) else value
