"""Lists and lengths as code writes them."""

import math
import re

_PRODUCT = r"\d+(?:\s*\*\s*\d+)*"
_SUM = re.compile(rf"\s*({_PRODUCT}(?:\s*[+-]\s*{_PRODUCT})*)\s*")
_TERM = re.compile(rf"([+-]?)\s*({_PRODUCT})")
_MADE = re.compile(r"\s*(?:std::)?([A-Za-z_]\w*|)\s*(?:<[^(){};]*>)?\s*(?=[({])")


def whole_number(text: str) -> int | None:
    """The value of a number, or of a sum of products of numbers; None for other texts."""
    if _SUM.fullmatch(text) is None:
        return None
    terms = _TERM.findall(text)
    return sum((-1 if sign == "-" else 1) * math.prod(map(int, term.split("*"))) for sign, term in terms)


def made_of(text: str) -> tuple[str, str, list[str]] | None:
    """The type's name, the bracket, and the parts, of a text that begins with `{...}`, `Type{...}` or
    `Type(...)`."""
    match = _MADE.match(text)
    if match is None:
        return None
    return match[1], text[match.end()], bracketed_parts(text[match.end() :])


def bracketed_parts(text: str) -> list[str]:
    """The parts between the commas of the bracket that a text begins with."""
    parts, depth, quote, before = [""], 0, "", ""
    for character in text:
        is_quoted, escaped = bool(quote), before == "\\"
        if is_quoted:
            quote = "" if character == quote and not escaped else quote
        elif character in "\"'":
            quote = character
        elif character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        if depth == 0:
            break
        if depth == 1 and character == "," and not is_quoted:
            parts.append("")
        else:
            parts[-1] += character
        before = "" if escaped else character
    first, *others = parts
    return [part for part in (first[1:], *others) if part.strip()]
