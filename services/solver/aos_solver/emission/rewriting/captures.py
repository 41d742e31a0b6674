"""Edits for lambdas that draw: the source of draws is a variable of the emitted function."""

import re
from collections.abc import Iterator

from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Cpp, strip_comments

_INTRODUCER = re.compile(r"(?<![\w\])])\s*\[([^\[\]]*)\]\s*(?=[({]|mutable\b|->)")
_BY_REFERENCE = re.compile(r"\s*&\s*(?:,|$)")


def capture_edits(cpp: Cpp, drawing: frozenset[str]) -> Iterator[tuple[int, int, str]]:
    """Insertions (start, end, text) by offsets; `drawing` are the shared functions that draw.

    `[](double p) { return AOS.Bernoulli(p); }` becomes `[&AOS](double p) ...`, and `[=]` becomes `[=, &AOS]`.
    """
    code = strip_comments(cpp.code)
    drawn = [(m.extent.start, m.path[0]) for m in cpp.mentions if m.path[0] in DRAW_SOURCES]
    drawn += [(call.extent.start, "AOS") for call in cpp.calls if call.name[:1] and call.name[0] in drawing]
    for found in _INTRODUCER.finditer(code) if drawn else ():
        if _BY_REFERENCE.match(found[1]) or any(
            each.start <= found.start(1) < each.end for each in cpp.literals
        ):
            continue
        end = _end_of_body(code, found.end())
        sources = sorted({name for at, name in drawn if found.end() <= at < end})
        sources = [name for name in sources if f"&{name}" not in found[1].replace(" ", "")]
        if sources:
            text = ", ".join(f"&{name}" for name in sources)
            yield found.end(1), found.end(1), f", {text}" if found[1].strip() else text


def _end_of_body(code: str, start: int) -> int:
    """The end of the first block in braces behind a place."""
    depth = 0
    for at in range(code.find("{", start), len(code)):
        depth += {"{": 1, "}": -1}.get(code[at], 0)
        if depth == 0:
            return at
    return len(code)
