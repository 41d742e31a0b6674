"""The documents with estimated numbers, as a unified diff. Nothing is changed here."""

import difflib
from collections.abc import Iterable, Mapping

from aos_lab.calibration.draws import Draw
from aos_lab.calibration.estimation import PRIOR, DrawEstimate, Estimate
from aos_protocol.diagnostics import Span

_DIGITS = 4
_SAME = 0.5 * 10.0**-_DIGITS


def proposed_numbers(estimate: DrawEstimate) -> tuple[float, ...]:
    """Returns the numbers in place of the draw's; the weights of a discrete draw make 1.

    An outcome outside its interval gets its share of the records. Those inside share the rest as the
    documents have them. What the documents exclude stays 0. An outcome that they allow and that never came
    keeps half a record's weight: with 0 its first coming would be impossible.
    """
    possible = [outcome for outcome in estimate.outcomes if not outcome.is_excluded]
    inside = [outcome for outcome in possible if outcome.is_inside]
    hits = {outcome.outcome: outcome.count or PRIOR for outcome in possible}
    rest = max(sum(outcome.count for outcome in inside), PRIOR * len(inside))
    total = rest + sum(hits[outcome.outcome] for outcome in possible if not outcome.is_inside)
    weight_inside = sum(outcome.document for outcome in inside)

    def share(outcome: Estimate) -> float:
        if outcome.is_excluded:
            return 0.0
        of_document = rest * outcome.document / weight_inside if outcome.is_inside else 0.0
        return round((of_document or hits[outcome.outcome]) / total, _DIGITS)

    shares = [share(outcome) for outcome in estimate.outcomes]
    if estimate.draw.kind == "Bernoulli":
        return (shares[1],)
    largest = shares.index(max(shares))
    others = sum(share for number, share in enumerate(shares) if number != largest)
    shares[largest] = round(1 - others, _DIGITS)
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
            if abs(float(old.rstrip("fF")) - new) >= _SAME:
                edits.setdefault(span.file, []).append((span, old, f"{new:g}"))
    parts: list[str] = []
    left_out: list[str] = []
    for name, changes in sorted(edits.items()):
        lines = files[name].decode("utf-8").splitlines(keepends=True)
        changed = list(lines)
        for span, old, value in sorted(changes, key=lambda change: -change[0].column):
            line, start = changed[span.line - 1], span.column - 1
            if line[start : start + len(old)] != old:
                left_out.append(f"{span}: {old} has to become {value} by hand")
                continue
            changed[span.line - 1] = line[:start] + value + line[start + len(old) :]
        path = paths[name]
        parts += difflib.unified_diff(lines, changed, f"a/{path}", f"b/{path}")
    return "".join(parts), tuple(left_out)
