"""The version a document declares, and which of two is higher."""

import re

from aos_language.findings import Findings
from aos_language.reading.source import Text

_VERSION = re.compile(r"\d{1,9}(\.\d{1,9}){0,3}")


def read_version(value: Text | None, findings: Findings) -> Text | None:
    """One to four numbers joined by dots; None, with a warning, for anything else that is there."""
    if value is None or not value.text:
        return None
    if not _VERSION.fullmatch(value.text):
        hint = "It is not compared; write one to four numbers joined by dots, such as 1.2.0"
        findings.warning("AOS106", f"{value.text!r} is no version", value.span, hint)
        return None
    return value


def is_higher(version: str, other: str) -> bool:
    """Number by number; numbers that are not given are 0."""
    return _numbers(version) > _numbers(other)


def _numbers(version: str) -> list[int]:
    numbers = [int(number) for number in version.split(".")]
    return numbers + [0] * (4 - len(numbers))
