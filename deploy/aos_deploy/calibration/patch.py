"""What documents would say with estimated numbers, as a unified diff. Nothing is changed here."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping

from aos_deploy.calibration.draws import Draw
from aos_deploy.calibration.estimation import PRIOR, DrawEstimate
from aos_protocol.diagnostics import Span

__all__ = ["patch_of", "proposed_numbers"]

_DIGITS = 4


def proposed_numbers(estimate: DrawEstimate) -> tuple[float, ...]:
    """In place of the draw's numbers; the weights of a discrete draw make 1.

    An outcome that the documents allow and that never came keeps half a record's weight: with 0 its first
    coming would be impossible.
    """
    hits = [outcome.count or (PRIOR if outcome.document > 0 else 0.0) for outcome in estimate.outcomes]
    shares = [round(each / sum(hits), _DIGITS) for each in hits]
    if estimate.draw.kind == "Bernoulli":
        return (shares[1],)
    largest = shares.index(max(shares))
    rest = 1 - sum(share for number, share in enumerate(shares) if number != largest)
    shares[largest] = round(rest, _DIGITS)
    return tuple(shares)


def patch_of(
    estimates: Iterable[DrawEstimate], files: Mapping[str, bytes], paths: Mapping[str, str]
) -> tuple[str, tuple[str, ...]]:
    """The diff, and what it leaves out: numbers that do not stand in a document as they are used.

    `files` are the documents by the names in their places, `paths` how the diff names them.
    """
    edits: dict[str, list[tuple[Span, str, str]]] = {}
    for estimate in estimates:
        draw: Draw = estimate.draw
        for span, old, new in zip(draw.places, draw.texts, proposed_numbers(estimate), strict=True):
            edits.setdefault(span.file, []).append((span, old, f"{new:g}"))
    parts: list[str] = []
    left_out: list[str] = []
    for name, changes in sorted(edits.items()):
        lines = files[name].decode("utf-8").splitlines(keepends=True)
        changed = list(lines)
        for span, old, value in sorted(changes, key=lambda each: -each[0].column):
            line, start = changed[span.line - 1], span.column - 1
            if line[start : start + len(old)] != old:
                left_out.append(f"{span}: {old} has to become {value} by hand")
                continue
            changed[span.line - 1] = line[:start] + value + line[start + len(old) :]
        path = paths[name]
        parts += difflib.unified_diff(lines, changed, f"a/{path}", f"b/{path}")
    return "".join(parts), tuple(left_out)
