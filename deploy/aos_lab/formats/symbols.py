"""Names as problem files and C can have them."""

import re
from collections.abc import Iterable

_NO_SYMBOL = re.compile(r"[^A-Za-z0-9_]+")
_RESERVED = frozenset({
    "T", "O", "R", "discount", "values", "states", "actions", "observations", "start", "include", "exclude",
    "uniform", "identity", "reset", "reward", "cost", "null",
})  # fmt: skip


def symbols(names: Iterable[str]) -> list[str]:
    """Returns for each name one of letters, digits and `_` that is like it and unlike all others."""
    found: dict[str, None] = {}
    for name in names:
        symbol = _NO_SYMBOL.sub("_", name).strip("_") or "x"
        if symbol in _RESERVED or not symbol[0].isalpha():
            symbol = f"x_{symbol}"
        unique, number = symbol, 2
        while unique in found:
            unique, number = f"{symbol}_{number}", number + 1
        found[unique] = None
    return list(found)
