"""The collector of what is found in documents: every check adds to it, nothing is raised."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from msgspec.structs import replace

from aos_protocol.diagnostics import Diagnostic, Mend, Severity, Span, has_errors
from aos_protocol.spelling import nearest

MAX_OF_A_SEVERITY = 1000
"""So many errors, warnings and remarks of a run are told: hostile text has one at each character."""
_LONGEST_EXCERPT = 4000
_EXCERPT_MARGIN = 200


class Findings:
    """The diagnostics of one run, each with the source line it is about where its file's lines are known."""

    def __init__(self, lines: Mapping[str, Sequence[str]] | None = None) -> None:
        self._diagnostics: list[Diagnostic] = []
        self._lines: dict[str, Sequence[str]] = dict(lines or {})
        self._counts: Counter[Severity] = Counter()

    def add_source(self, file: str, lines: Sequence[str]) -> None:
        """Takes a file's lines: findings in it show theirs from now on."""
        self._lines[file] = lines

    def lines_of(self, file: str) -> Sequence[str]:
        """The lines of a file, as far as they are known."""
        return self._lines.get(file, ())

    def error(self, code: str, message: str, span: Span, hint: str = "", mend: Mend | None = None) -> None:
        self.add(Diagnostic(Severity.ERROR, code, message, span, hint, mend=mend))

    def warning(self, code: str, message: str, span: Span, hint: str = "", mend: Mend | None = None) -> None:
        self.add(Diagnostic(Severity.WARNING, code, message, span, hint, mend=mend))

    def remark(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.add(Diagnostic(Severity.REMARK, code, message, span, hint))

    def unknown(
        self,
        name: str,
        known: Iterable[str],
        message: str,
        span: Span,
        otherwise: str = "",
        *,
        code: str = "AOS110",
        severity: Severity = Severity.ERROR,
    ) -> None:
        """A name that means nothing. The hint is the nearest known name, else what stands in `otherwise`."""
        close = nearest(name, known) if self._has_place(severity) else ""
        hint = f"Did you mean `{close}`?" if close else otherwise
        mend = Mend(span, len(name), close) if close and self._stands_at(name, span) else None
        self.add(Diagnostic(severity, code, message, span, hint, mend=mend))

    def add(self, diagnostic: Diagnostic) -> None:
        """A finding, which gets the source line it is about where it has none.

        Where there are very many of its severity it is left out, and the first of these says so.
        """
        severity = diagnostic.severity
        self._counts[severity] += 1
        if not self._has_place(severity):
            if self._counts[severity] > MAX_OF_A_SEVERITY + 1:
                return
            message = f"there are more than {MAX_OF_A_SEVERITY} of these; the rest is not told"
            diagnostic = Diagnostic(severity, diagnostic.code, message, diagnostic.span)
        excerpt = diagnostic.excerpt or self._excerpt(diagnostic.span)
        self._diagnostics.append(replace(diagnostic, excerpt=excerpt))

    def __len__(self) -> int:
        return len(self._diagnostics)

    @property
    def has_errors(self) -> bool:
        return has_errors(self._diagnostics)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The diagnostics in the order in which they were found."""
        return tuple(self._diagnostics)

    def sorted(self) -> tuple[Diagnostic, ...]:
        """Returns the diagnostics by file and place; what is said twice is said once."""
        unique = dict.fromkeys(self._diagnostics)
        return tuple(sorted(unique, key=lambda diagnostic: (diagnostic.span, diagnostic.code)))

    def _has_place(self, severity: Severity) -> bool:
        return self._counts[severity] <= MAX_OF_A_SEVERITY

    def _line(self, span: Span) -> str:
        lines = self.lines_of(span.file)
        return lines[span.line - 1].rstrip() if 0 < span.line <= len(lines) else ""

    def _excerpt(self, span: Span) -> str:
        return self._line(span)[: span.column + _EXCERPT_MARGIN] if span.column <= _LONGEST_EXCERPT else ""

    def _stands_at(self, name: str, span: Span) -> bool:
        return span.column > 0 and self._line(span).startswith(name, span.column - 1)
