"""Findings that go when another one is mended are left out, so that a mistake is told once.

They are known by their codes, files and names alone. Editors mark each place, and do not use this.
"""

from collections.abc import Hashable, Iterable
from pathlib import PurePath

from msgspec.structs import replace

from aos_protocol.diagnostics import Diagnostic, Span

_UNREAD = frozenset(("AOS101", "AOS102", "AOS103", "AOS104", "AOS107", "AOS108"))
"""Text that is not taken up as it stands, with what it declares."""
_STRAY = "AOS104"
_OF_NAMES = frozenset(("AOS110", "AOS116", "AOS123", "AOS201"))
_NEEDS_DECLARATION = frozenset(("AOS110", "AOS116", "AOS119"))
_OF_CODE = frozenset(("AOS122", "AOS149"))
"""Codes of what a piece of code says by itself."""
_UNUSED = frozenset(("AOS117", "AOS133"))
_SHOWN = 6


def told_once(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Returns the findings without those that follow from others.

    Left out are warnings and remarks on a file with errors, but for those on other lines that a piece of code
    says by itself. Where text is not taken up, so is what its file
    lacks. Where it is not, or an object of JSON lacks a key, so are names that nothing declares and no other
    name is near, in files that use what it declares. What nothing uses is not told where an unknown name may
    have meant it. A compiler's error is left out where another error stands before it in its line. A name
    that stands at several places is told at the first, with the others in the hint.
    """
    found = tuple(diagnostics)
    errors = [one for one in found if one.is_error]
    unread = {one.span.file for one in errors if one.code in _UNREAD}
    partial = unread | {one.span.file for one in errors if _may_leave_out(one)}
    wrong = {one.span.file for one in errors}
    lines: dict[tuple[str, int], Diagnostic] = {}
    for error in errors:
        lines.setdefault((error.span.file, error.span.line), error)

    meant = {one.mend.text for one in errors if one.code in _OF_NAMES and one.mend is not None}

    def follows(one: Diagnostic) -> bool:
        if not one.is_error:
            names = meant if one.code in _UNUSED else ()
            stands_here = (one.excerpt.startswith(name, one.span.column - 1) for name in names)
            is_apart = one.code in _OF_CODE and one.span.file not in unread
            is_apart = is_apart and (one.span.file, one.span.line) not in lines
            return (one.span.file in wrong and not is_apart) or any(stands_here)
        match one.code:
            case "AOS105":
                return one.span.file in unread
            case "AOS201":
                return lines[one.span.file, one.span.line] is not one
        is_of_partial = any(_declares_for(file, one.span.file) for file in partial)
        return one.code in _NEEDS_DECLARATION and is_of_partial and one.mend is None

    groups: dict[Hashable, list[Diagnostic]] = {}
    for number, one in enumerate(found):
        if not follows(one):
            groups.setdefault(_key(one) or number, []).append(one)
    return tuple(_with_places(first, [one.span for one in rest]) for first, *rest in groups.values())


def _key(one: Diagnostic) -> Hashable | None:
    """Returns what findings of one mistake have in common."""
    if one.code in _OF_NAMES:
        return one.code, one.message, one.hint
    return (one.code, one.message, one.span.file) if one.code == _STRAY else None


def _may_leave_out(one: Diagnostic) -> bool:
    """Returns whether an object of a JSON document lacks a key, such as its name, without which it declares
    nothing."""
    return one.code == "AOS105" and one.span.file.endswith(".json")


def _declares_for(file: str, user: str) -> bool:
    """Returns whether a file may declare what another one uses.

    An environment and low-level types do for all files, a skill and its mapping for each other. The name of a
    JSON document does not say what it is.
    """
    return file.endswith((".ef", ".lf", ".json")) or PurePath(file).stem == PurePath(user).stem


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
    return replace(first, hint=hint, mend=None)
