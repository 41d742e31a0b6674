"""The one-line forms of SDL: `<type> <name> ...`, numbers, and values."""

import re
from collections.abc import Collection

import msgspec

from aos_language.reading.document import check_name, normal_type
from aos_language.reading.sdl_text import Part
from aos_language.reading.source import Text
from aos_protocol.diagnostics import Mend

_DECLARATION = re.compile(
    r"((?:(?:unsigned|signed|long|short)(?:\s+(?:unsigned|signed|long|short|int|char|double)\b)*(?=\s)"
    r"|[A-Za-z_][\w:]*)(?:\s*<.*>)?(?:\s*\[\s*(?:[A-Za-z_]\w*)?\s*\])?)(\s+)([^\s\[=]+)(\s*)"
)
_BASIC = ("int", "float", "double", "bool", "string")
_NAME = re.compile(r"[A-Za-z_]\w*")
_TRUTHS = {"true": True, "false": False}


class Declaration(msgspec.Struct, frozen=True):
    """`type name rest`."""

    type: str
    type_text: Text
    name: Text
    rest: Text


def read_declaration(part: Part, what: str, types: Collection[str] = ()) -> Declaration | None:
    """The declaration in a part's value; None, with an error, where it is none.

    Where the name stands before one of these types, or a basic one, it is read as meant. A name alone is of
    type `auto`.
    """
    known = {*_BASIC, *types}
    match = _DECLARATION.match(part.value.text)
    if match is None:
        message = f"`{part.word}:` needs a type and a name"
        text = part.value
        is_name = _NAME.fullmatch(text.text) is not None and text.text not in known
        hint = f"Write `int {text.text}`, or another type before the name" if is_name else ""
        part.findings.error("AOS104", message, text.span if text.text else part.span, hint)
        return Declaration("auto", text, text, text.after(len(text.text))) if is_name else None
    type_text = Text(match.group(1), part.value.after(0).span)
    name = Text(match.group(3), part.value.after(match.start(3)).span)
    if name.text in known and type_text.text not in known and (bare := _NAME.match(type_text.text)):
        meant = f"{name.text} {bare[0]}{type_text.text[bare.end() :].lstrip()}"
        mend = Mend(type_text.span, match.end(3), meant)
        part.findings.error("AOS104", f"the type comes first: `{meant}`", type_text.span, mend=mend)
        array_mark = type_text.after(bare.end()).strip()
        rest = array_mark if array_mark.text else part.value.after(match.end()).strip()
        return Declaration(name.text, name, Text(bare[0], type_text.span), rest)
    rest = part.value.after(match.end()).strip()
    first, mark, _ = name.text.partition(",")
    if mark:
        part.findings.error("AOS104", f"`{part.word}:` declares one name", name.span, "Write a line for each")
        name, rest = Text(first, name.span), rest.after(len(rest.text))
    elif name.text.endswith(";"):
        name = Text(name.text.rstrip(";"), name.span)
        at = name.after(len(name.text)).span
        part.findings.warning("AOS127", "a semicolon after a name", at, "It is skipped")
    check_name(name, what, part.findings)
    return Declaration(normal_type(type_text, part.findings), type_text, name, rest)


def read_number(part: Part) -> float | None:
    """The number in a part's value; None, with an error, where it is none."""
    text = part.value.text
    if text.endswith(";"):
        text = text.rstrip("; \t")
        at = part.value.after(len(text)).strip().span
        part.findings.warning("AOS127", "a semicolon after a number", at, "It is skipped")
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not abs(number) < float("inf"):
        span = part.place
        hint = "A decimal is written with a point" if "," in text else ""
        part.findings.error("AOS106", f"`{part.word}:` needs a number, not {part.value.text!r}", span, hint)
        return None
    return number


def read_truth(part: Part | None, *, otherwise: bool = False) -> bool:
    """true or false in a part's value, `otherwise` where it is neither; false where there is no part."""
    if part is None:
        return False
    truth = _TRUTHS.get(part.value.text.lower())
    if truth is None:
        message = f"`{part.word}:` is true or false, not {part.value.text!r}"
        part.findings.error("AOS106", message, part.value.span)
    return otherwise if truth is None else truth
