"""The numbers that model code reports beside a response: `__observed.NAME = AOS.SampleNormal(mean, sd)`.

What is assigned is one draw, so that its density is known, and nothing may look at what was drawn. Everything
else that is done with `__observed` is a misuse.
"""

import re
from collections.abc import Iterator

import msgspec

from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Access, Call, Cpp, Extent, Mention, strip_comments
from aos_language.document_code import snippets_of
from aos_protocol.documents import SkillModel, Snippet

OBSERVED = "__observed"

_DRAWS = ("Bernoulli", "SampleDiscrete", "SampleNormal", "SampleUniform")
_STATEMENT_BEFORE = re.compile(r"(?:^|[;{}):]|\b(?:else|do))\s*$")


class ReportedNumber(msgspec.Struct, frozen=True):
    """A number, or an array of numbers, that a skill reports; `snippet` and `extent` are its first report."""

    name: str
    is_array: bool
    snippet: Snippet
    extent: Extent


class Report(msgspec.Struct, frozen=True):
    """One place where a draw is reported."""

    mention: Mention
    draw: Call

    @property
    def name(self) -> str:
        return self.mention.path[1]

    @property
    def is_array(self) -> bool:
        return len(self.mention.path) == 3 or self.mention.method == "push_back"


class Misuse(msgspec.Struct, frozen=True):
    """A use of `__observed` that cannot be, at a place of a snippet."""

    extent: Extent
    message: str
    hint: str


def reports_in(cpp: Cpp) -> tuple[Report, ...]:
    """The reports of a snippet of a dynamic model."""
    return tuple(found for found in _read(cpp) if isinstance(found, Report))


def misuses_of(cpp: Cpp) -> tuple[Misuse, ...]:
    """Returns the uses of `__observed` in a snippet of a dynamic model that are no reports."""
    return tuple(found for found in _read(cpp) if isinstance(found, Misuse))


def reported_numbers(model: SkillModel) -> tuple[ReportedNumber, ...]:
    """The numbers of a skill, each once, in the order of their first reports."""
    numbers: dict[str, ReportedNumber] = {}
    for snippet, cpp in snippets_of(model.dynamic_model):
        for report in reports_in(cpp):
            number = ReportedNumber(report.name, report.is_array, snippet, report.mention.extent)
            numbers.setdefault(report.name, number)
    return tuple(numbers.values())


def _read(cpp: Cpp) -> Iterator[Report | Misuse]:
    mentions = [mention for mention in cpp.mentions if mention.path[0] == OBSERVED]
    if mentions:
        code = strip_comments(cpp.code)
        yield from (_report_or_misuse(mention, cpp, code) for mention in mentions)


def _report_or_misuse(mention: Mention, cpp: Cpp, code: str) -> Report | Misuse:
    if len(mention.path) < 2 or not code[mention.root.end :].lstrip().startswith("."):
        return Misuse(mention.extent, f"`{OBSERVED}` is used as a value", _to_write("NAME"))
    name, reported = mention.path[1], _reported(mention, cpp, code)
    if reported is None:
        is_read = mention.access is Access.READ and not mention.method
        hint = "No model code can look at a reported number; look at the state that it is drawn for"
        message = f"`{mention.text}` is {'read' if is_read else 'changed'}, and may only be reported"
        return Misuse(mention.extent, message, hint if is_read else _to_write(name))
    if not _STATEMENT_BEFORE.search(code[: mention.extent.start]):
        message = f"`{mention.text}` is reported within an expression"
        return Misuse(mention.extent, message, f"Make it a statement: {_example(name)}")
    if len(mention.path) > 2 and mention.path[2:] != ("[]",):
        hint = f"There are numbers and arrays of them. {_to_write(f'{name}[i]')}"
        return Misuse(mention.extent, f"`{mention.text}` is no number", hint)
    for call in cpp.calls:
        if is_draw(call) and call.extent.start == reported.start and call.extent.end == reported.end:
            return Report(mention, call)
    message = f"`{mention.text}` is not reported straight from one draw, so its density is not known"
    hint = "Write the draw alone, arithmetic within its arguments, and a statement for each case"
    is_drawn = any(is_draw(call) and reported.start <= call.extent.start < reported.end for call in cpp.calls)
    mean = "mean" if is_drawn else code[reported.start : reported.end]
    return Misuse(reported, message, f"{hint}: {_example(name, mean)}")


def is_draw(call: Call) -> bool:
    """Returns whether it is a call such as `AOS.Bernoulli(p)`."""
    return len(call.name) == 2 and call.name[0] in DRAW_SOURCES and call.name[1] in _DRAWS


def _to_write(name: str) -> str:
    return f"Write {_example(name)}, or another draw"


def _example(name: str, mean: str = "mean") -> str:
    return f"`{OBSERVED}.{name} = AOS.SampleNormal({mean}, deviation);`"


def _reported(mention: Mention, cpp: Cpp, code: str) -> Extent | None:
    """Returns the expression that is assigned or appended, without the blanks around it; None for any
    other use."""
    if mention.access is Access.WRITE and mention.assigned is not None and not mention.method:
        return _stripped(mention.assigned, code)
    if mention.method == "push_back" and len(mention.path) == 2:
        calls = (call for call in cpp.calls if call.extent.start == mention.extent.start)
        for call in calls:
            if len(call.arguments) == 1:
                return _stripped(call.arguments[0], code)
    return None


def _stripped(extent: Extent, code: str) -> Extent:
    text = code[extent.start : extent.end]
    start = extent.start + len(text) - len(text.lstrip())
    return extent._replace(start=start, end=extent.start + len(text.rstrip()))
