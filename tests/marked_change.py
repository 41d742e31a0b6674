"""A change of a document in one line: `horizon: §«8→ten»` turns the first `horizon: 8` into `horizon: ten`.

A change may have several parts. § marks the place that a finding has to point at.
"""

import re
from collections.abc import Mapping

from aos_protocol.diagnostics import Span

_PART = re.compile("«(.*?)→(.*?)»", re.DOTALL)
_MARK = "§"


def changed(files: Mapping[str, bytes], file: str, change: str) -> tuple[dict[str, bytes], Span]:
    """The documents after the change of one of them, and the marked place; without a mark the file alone."""
    text, found = files[file].decode(), _PART.sub(r"\1", change).replace(_MARK, "")
    assert found in text, f"{change!r}: {found!r} is not in {file}"
    before, mark, after = text.replace(found, _PART.sub(r"\2", change), 1).partition(_MARK)
    place = Span(file)
    if mark:
        place = Span(file, before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
    return {**files, file: (before + after).encode()}, place
