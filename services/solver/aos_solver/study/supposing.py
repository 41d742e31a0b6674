"""Suppositions as text: another probability of a variable's value, another number in a document.

A belief is put aside while others are supposed.
"""

import math
import re
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from typing import NamedTuple

from aos_language.number_text import is_number
from aos_protocol.errors import SkillError, StudyError
from aos_protocol.messages import BeliefSummary
from aos_solver.child.engine import Engine

_NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
_OPERAND_BEFORE = re.compile(r"[\w)\]]\s*$")
_CHANGE = re.compile(r"(?P<file>.+?):(?P<line>\d+)(?::(?P<column>\d+))?=(?P<number>.+)")
_SHOWN_NAMES = 12


class Supposition(NamedTuple):
    """The probability that a variable has a value."""

    variable: str
    value: str
    probability: float


def supposition_of(text: str) -> Supposition:
    """Reads `variable=value:p`; StudyError AOS530 where it is not of this form."""
    what, colon, number = text.rpartition(":")
    variable, equals, value = what.partition("=")
    if not (colon and equals and variable.strip()):
        raise StudyError(f"{text!r} says no belief", hint='Write it as "holding_can=true:0.5"')
    try:
        probability = float(number)
    except ValueError:
        probability = math.nan
    if not 0 <= probability <= 1:
        raise StudyError(f"{number} is no probability", hint='Write it as "holding_can=true:0.5"')
    return Supposition(variable.strip(), value.strip(), probability)


async def believe_all(engine: Engine, texts: Iterable[str], *, cautious: bool = False) -> tuple[str, ...]:
    """Changes what an engine believes, one supposition after the other; says what was believed before.

    SkillError AOS501 for a variable that there is not, StudyError AOS530 for what the belief excludes.
    """
    said = []
    for wanted in map(supposition_of, texts):
        believed = await engine.believe(*wanted, cautious=cautious)
        named = f"{wanted.variable}={wanted.value}"
        if not believed.has_variable:
            names = _names(believed.summary)
            raise SkillError(
                f"there is no variable {wanted.variable}", code="AOS501", hint=f"Name one of {names}"
            )
        if believed.probability <= 0 < wanted.probability:
            message = f"{named} is excluded: no state that is believed to be possible has it"
            raise StudyError(message, hint=f"Believed are {_values(believed.summary, wanted.variable)}")
        if believed.probability >= 1 > wanted.probability:
            message = f"anything but {named} is excluded: every state that is believed to be possible has it"
            raise StudyError(message, hint="Suppose something of a variable that is in doubt")
        said.append(f"{named}: {wanted.probability:g} instead of {believed.probability:.6g}")
    return tuple(said)


def _names(belief: BeliefSummary) -> str:
    names = [marginal.variable for marginal in belief.marginals]
    more = f" and {len(names) - _SHOWN_NAMES} others" if len(names) > _SHOWN_NAMES else ""
    return ", ".join(names[:_SHOWN_NAMES]) + more


def _values(belief: BeliefSummary, variable: str) -> str:
    found = next((m.values for m in belief.marginals if m.variable == variable), {})
    return ", ".join(f"{variable}={value}" for value in list(found)[:_SHOWN_NAMES])


def changed_files(
    files: dict[str, bytes], changes: Iterable[str]
) -> tuple[dict[str, bytes], tuple[str, ...]]:
    """The files with other numbers, each change as `file:line=number` or `file:line:column=number`.

    Also says what each number was. StudyError AOS530 where the place has no number, or several.
    """
    said = []
    for change in changes:
        match = _CHANGE.fullmatch(change.strip())
        if match is None or not is_number(match["number"]):
            raise StudyError(f"{change!r} changes no number", hint='Write it as "pick.sd:17=0.8"')
        name, line = match["file"], int(match["line"])
        if name not in files:
            raise StudyError(f"the documents have no file {name}", hint=f"Name one of {', '.join(files)}")
        lines = files[name].decode().split("\n")
        if not 1 <= line <= len(lines):
            raise StudyError(f"{name} has {len(lines)} lines, and no line {line}")
        column = int(match["column"]) if match["column"] else None
        start, end = _place_of_number(lines[line - 1], f"{name}:{line}", column)
        old, new = lines[line - 1][start:end], match["number"].strip()
        lines[line - 1] = lines[line - 1][:start] + new + lines[line - 1][end:]
        files = {**files, name: "\n".join(lines).encode()}
        said.append(f"{name}:{line}: {new} instead of {old}")
    return files, tuple(said)


def _place_of_number(text: str, place: str, column: int | None) -> tuple[int, int]:
    """The start and end of a line's only number, or of the one at a column."""
    found = []
    for match in _NUMBER.finditer(text):
        start, before = match.start(), text[: match.start()].rstrip()
        if before.endswith("-") and not _OPERAND_BEFORE.search(before[:-1]):
            start = len(before) - 1
        found.append((start, match.end()))
    if column is not None:
        found = [(start, end) for start, end in found if start < column <= end]
    if len(found) == 1:
        return found[0]
    if not found:
        raise StudyError(f"{place} has no number there: {text.strip()}", hint="Name a line with a number")
    columns = ", ".join(f"{place}:{start + 1}={text[start:end]}" for start, end in found)
    raise StudyError(f"{place} has {len(found)} numbers", hint=f"Name one by its column: {columns}")


@asynccontextmanager
async def put_aside(engine: Engine) -> AsyncIterator[None]:
    """Gives an engine its belief back at the end, also where a question was refused.

    After any other error, or where nobody waits for the end, the engine is of no use any more.
    """
    await engine.put_aside()
    try:
        yield
    except SkillError:
        await engine.take_back()
        raise
    await engine.take_back()
