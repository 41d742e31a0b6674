"""The tables of docs/limits.md: limits that a user can meet, with their values read from the sources.

Behind each value stand its place and its unit, in a comment. A place is `module.CONSTANT` or
`module.Struct.field` of Python, or `header:name` below the engine's `aos`. A value that has moved is an
error here, so that the page cannot tell an old one.
"""

import importlib
import re
from pathlib import Path

import msgspec

LIMITS = Path(__file__).with_name("limits.md")
VALUE = re.compile(r"[^|]*<!-- (\S+) (\w* ?)--> ")
ENGINE = Path(__file__).resolve().parents[1] / "services/solver/aos_solver/cpp/aos"


def limits_table() -> str:
    """The tables of the page, with the values of now."""
    page = LIMITS.read_text(encoding="utf-8")
    tables = page.partition("<!-- generated: limits -->\n")[2].partition("<!-- end -->")[0]
    return VALUE.sub(
        lambda found: f" {_text(value_at(found[1]), found[2].strip())} <!-- {found[1]} {found[2]}--> ",
        tables.strip("\n") + "\n",
    )


def value_at(place: str) -> float:
    """The value of a constant or of a field's default; AttributeError if it is not there any more."""
    if ".hpp:" in place:
        return _value_in_header(*place.split(":"))
    parts = place.split(".")
    try:
        if parts[-2][0].isupper():
            struct = getattr(importlib.import_module(".".join(parts[:-2])), parts[-2])
            return next(field.default for field in msgspec.structs.fields(struct) if field.name == parts[-1])
        return float(getattr(importlib.import_module(".".join(parts[:-1])), parts[-1]))
    except (AttributeError, ImportError, StopIteration) as error:
        raise AttributeError(f"docs/limits_table.py: {place} is not there any more") from error


def _value_in_header(header: str, name: str) -> float:
    text = (ENGINE / header).read_text(encoding="utf-8")
    found = re.search(rf"\b{name} = (?:std::size_t\{{(\d+)\}} << )?([\d']+)", text)
    if found is None:
        raise AttributeError(f"docs/limits_table.py: {header} has no {name} any more")
    number = int(found[2].replace("'", ""))
    return int(found[1]) << number if found[1] else number


def _text(value: float, unit: str) -> str:
    if unit == "bytes" and value % 10**6 == 0:
        return f"{value / 10**6:g} MB"
    if unit == "bytes":
        return next(
            f"{value / size:g} {name}"
            for name, size in (("GiB", 2**30), ("MiB", 2**20), ("KiB", 2**10), ("bytes", 1))
            if value >= size
        )
    if unit == "s":
        return f"{value / 86400:g} days" if value >= 86400 else f"{value:g} s"
    return f"{value:,g} {unit}".strip() if value < 1e6 else f"{int(value):,} {unit}".strip()
