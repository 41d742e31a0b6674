"""Findings that go when another one is mended are left out, so that a mistake is told once.

The language server does not use this: an editor marks each place.
"""

import re
from collections.abc import Hashable, Iterable

import msgspec

from aos_protocol.diagnostics import Diagnostic, Span, has_errors

_NAME = re.compile(r"`(\w+)`")
_MEANT = re.compile(r"Did you mean `(\w+)`\?")
_OF_NAMES = ("AOS110", "AOS116", "AOS123", "AOS201")
_SHOWN, _NEAR_LINES = 6, 8
_WORD = re.compile(r"\w+")
_TEXT = re.compile(r"'(\w+)'")
_DECLARING = ("AOS102", "AOS103", "AOS104", "AOS105", "AOS106", "AOS108", "AOS121")
_OF_DECLARATIONS = re.compile(
    "cannot be the name|(enum_members|`code|default_value|variable|parameter|define_type):|temporary|constant"
    '|is empty|or has variables|lacks "(Name|Type|VarName)'
)
_BESIDE = (
    *("AOS102", "AOS103", "AOS104", "AOS105", "AOS108", "AOS119", "AOS121", "AOS125", "AOS127", "AOS141"),
    *("AOS137", "AOS139", "AOS149", "AOS201"),
)


def told_once(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Returns the findings without those that follow from others.

    A name that nothing declares is told where it stands first, with the other places in the hint.
    """
    found = tuple(diagnostics)
    causes = _Causes(found)
    left = [causes.at_its_text(one) for one in found if not causes.explain(one)]
    if has_errors(left) != has_errors(found):
        return found
    groups: dict[Hashable, list[Diagnostic]] = {}
    for number, one in enumerate(left):
        groups.setdefault(_name_key(one) or number, []).append(one)
    return tuple(_with_places(first, [one.span for one in rest]) for first, *rest in groups.values())


def _name_key(one: Diagnostic) -> Hashable | None:
    """Returns what findings of one name have in common. Each file of Python has names of its own."""
    names = _NAME.findall(one.message)
    if one.code not in _OF_NAMES or len(names) != 1:
        return None
    if one.message.startswith("there is no `"):
        return one.message.partition(" in ")[2], one.span.file
    if str(names[0]).startswith("___"):
        return str(names[0])
    is_local = one.code == "AOS123" or "local variable" in one.message
    message = "" if one.message.startswith("unknown ") else one.message
    return one.code, one.severity, names[0], message, one.span.file if is_local else ""


def _with_places(first: Diagnostic, others: list[Span]) -> Diagnostic:
    lines = dict.fromkeys(
        f"line {span.line}" if span.file == first.span.file else f"{span.file}:{span.line}"
        for span in others
        if (span.file, span.line) != (first.span.file, first.span.line)
    )
    if not lines:
        return first
    more = f" and {len(lines) - _SHOWN} more" if len(lines) > _SHOWN else ""
    hint = f"{first.hint} Also: {', '.join([*lines][:_SHOWN])}{more}".strip()
    return msgspec.structs.replace(first, hint=hint, mend=None)


class _Causes:
    """The findings from which others follow."""

    def __init__(self, found: tuple[Diagnostic, ...]) -> None:
        errors = [one for one in found if one.is_error]
        named = [one for one in errors if one.code in ("AOS110", "AOS116", "AOS126")]
        self._unknown = {name for one in named for name in _NAME.findall(one.message)}
        self._meant = {name for one in named for name in _MEANT.findall(one.hint)}
        self._named_lines = {(one.span.file, one.span.line) for one in errors if one.code == "AOS110"}
        # What has a mend is read all the same.
        self._unread = [
            one
            for one in errors
            if (one.code in _DECLARING and (one.mend is None or one.code not in ("AOS102", "AOS104")))
            or "cannot be the name" in one.message
        ]
        lost = [one for one in self._unread if _loses_a_declaration(one) or one.code == "AOS121"]
        self._has_lost = any(one.code != "AOS121" for one in lost)
        self._lost_words = {word for one in lost for word in _WORD.findall(one.excerpt)}
        self._lost_words |= {
            name
            for one in errors
            if one.message.startswith("unknown state variable")
            and any(_is_near(two, one) for two in lost if two.code == "AOS103")
            for name in _NAME.findall(one.message)
        }
        self._of_file: dict[str, list[Diagnostic]] = {}
        for one in found:
            if one.is_error or one.code == "AOS108":
                self._of_file.setdefault(one.span.file, []).append(one)

    def at_its_text(self, one: Diagnostic) -> Diagnostic:
        """Moves what a file lacks to the text that stands there without it."""
        text = next(filter(_is_stray, self._of_file.get(one.span.file, [])), None)
        if text is None or not _lacks_a_model(one):
            return one
        hint = text.hint or "Write it above this text"
        return msgspec.structs.replace(one, span=text.span, excerpt=text.excerpt, hint=hint)

    def explain(self, one: Diagnostic) -> bool:
        """Returns whether a finding follows from another."""
        others = self._of_file.get(one.span.file, [])
        if one.code == "AOS149" and self._unknown & set(_TEXT.findall(one.message)):
            return True
        if one.code == "AOS201" and self._unknown & set(_WORD.findall(one.message)):
            return True
        if one.code == "AOS119" and self._has_lost:
            return True
        if one.code in _BESIDE:
            return any(_is_before(other, one) for other in others)
        match one.code:
            case "AOS133" | "AOS117":
                return self._explains_unused(one)
            case "AOS118":
                return any("has no rule" in other.message for other in others)
            case "AOS114" if "has no monitor" in one.message:
                return any("monitor" in other.message for other in self._unread)
            case "AOS114":
                return ", and the mapping" in one.message or any('lacks "Name"' in o.message for o in others)
            case "AOS140":
                return any(_is_of_locals(other) for other in self._unread)
            case "AOS110" | "AOS116" | "AOS123":
                return self._explains_name(one, others)
        return False

    def _explains_unused(self, one: Diagnostic) -> bool:
        if "never sets" in one.message:
            return False
        if (one.span.file, one.span.line) in self._named_lines:
            return True
        is_unread = any(other.code == "AOS108" or _is_stray(other) for other in self._unread)
        words = {
            one.message.split()[-1],
            *(name.removesuffix("Objects") for name in _NAME.findall(one.message)),
        }
        return is_unread or bool(words & (self._meant | self._unknown))

    def _explains_name(self, one: Diagnostic, others: list[Diagnostic]) -> bool:
        names = set(_NAME.findall(one.message))
        if one.message.startswith("there is no `"):
            return any(map(_lacks_a_model, others))
        if one.code == "AOS116" and any(o.code == "AOS110" and o.span == one.span for o in others):
            return True
        if names & self._lost_words or any(
            name.removesuffix("Objects") in self._unknown - {name} for name in names
        ):
            return True
        if "local variable" in one.message and any(
            _is_of_locals(o) or (o.code == "AOS121" and names & set(_NAME.findall(o.hint))) for o in others
        ):
            return True
        skill = one.message.partition(" of ")[2].partition(" has ")[0] if one.code == "AOS116" else ""
        if skill and any(o.span.file.startswith(skill) and "response" in o.message for o in self._unread):
            return True
        if _MEANT.search(one.hint):
            return False
        if "local variable" in one.message:
            return any(other.code == "AOS121" and other.span.file.endswith(".ef") for other in self._unread)
        return self._has_lost


def _is_before(other: Diagnostic, one: Diagnostic) -> bool:
    """Returns whether a finding follows from another that is near it in a file."""
    lines = other.span.line - one.span.line
    is_earlier = -_NEAR_LINES < lines < 0
    is_earlier_place = is_earlier or (lines == 0 and other.span.column < one.span.column)
    match one.code:
        case "AOS102":
            return (is_earlier and "has no code" in other.message) or (lines < 0 and _is_stray(other))
        case "AOS103" | "AOS125":
            is_twice = "is given more than once" in one.message and "is given more than once" in other.message
            return "more than one source" in other.message or (is_twice and is_earlier)
        case "AOS104" if "belongs to no `parameter:`" in one.message:
            return other.code == "AOS102" and is_earlier
        case "AOS104" if _is_stray(one):
            return _lacks_a_model(other)
        case "AOS137" | "AOS139":
            return other.code == "AOS108" or (other.code == "AOS110" and "`__" in other.message)
        case "AOS104":
            is_comma = one.message.startswith("a comma is missing")
            is_bracket = other.code == "AOS104" and other.message != one.message
            is_twice = other.message.startswith("the key") and lines == 1
            is_next = lines in (0, 1) or "never closed" in other.message
            return is_comma and (is_twice or (is_bracket and is_next))
        case "AOS108":
            is_compiled = other.code in ("AOS110", "AOS201") and lines == 0
            is_first = other.code == "AOS108" and is_earlier_place
            is_warning = not one.is_error
            return (is_warning and is_compiled) or (is_first and not one.message.startswith("this "))
        case "AOS201":
            is_syntax = is_earlier_place and one.message.startswith(("expected ", "`else` without"))
            is_beside = lines == 0 and is_earlier_place and other.message.startswith("expected ")
            is_of_type = "has no member" in one.message and "name a type" in other.message
            lost = is_of_type and not {*_NAME.findall(one.message)}.isdisjoint(_WORD.findall(other.excerpt))
            return other.code == "AOS201" and (is_syntax or is_beside or lost)
        case "AOS121":
            return "never assigns" in one.message and other.code == "AOS103" and is_earlier
        case "AOS127":
            return other.code in ("AOS104", "AOS105", "AOS108") and abs(lines) <= _NEAR_LINES
        case "AOS141" | "AOS149":
            return other.code == ("AOS110" if one.code == "AOS141" else "AOS108") and lines == 0
        case "AOS105" if " lacks `" in one.message:
            return other.code == "AOS102" and one.message.partition(" lacks ")[2] in other.hint
        case "AOS105" if " is empty" in one.message:
            return other.code == "AOS126" and "already the name of a type" in other.message
        case "AOS105" if "listens to no topic" in one.message:
            return _is_of_locals(other)
        case "AOS105" if other.span == one.span:
            return other.code == "AOS105" and other.message < one.message
    return _is_stray(other) and 0 < lines <= _NEAR_LINES


def _is_near(other: Diagnostic, one: Diagnostic) -> bool:
    return other.span.file == one.span.file and 0 < one.span.line - other.span.line <= _NEAR_LINES


def _is_stray(one: Diagnostic) -> bool:
    return one.code == "AOS104" and "belongs to no" in one.message


def _lacks_a_model(one: Diagnostic) -> bool:
    return "lacks `dynamic_model:`" in one.message


def _is_of_locals(one: Diagnostic) -> bool:
    """Returns whether an error leaves out a local variable or an import of a mapping."""
    told = f"{one.message} {one.hint}"
    return one.code in ("AOS102", "AOS103", "AOS104", "AOS105", "AOS106") and any(
        word in told for word in ("local variable", "local_variable:", "action_parameter", "import")
    )


def _loses_a_declaration(one: Diagnostic) -> bool:
    """Returns whether an error of the environment leaves out what code names."""
    if not one.span.file.endswith((".ef", ".lf", ".json")):
        return False
    told = f"{one.message} {one.hint}"
    return one.code == "AOS108" or _OF_DECLARATIONS.search(told) is not None
