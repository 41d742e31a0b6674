"""The diagnostics that one lowering collects."""

from __future__ import annotations

from aos_protocol.diagnostics import Diagnostic, Severity, Span

__all__ = ["Findings"]


class Findings:
    """Collects; raises nothing."""

    def __init__(self) -> None:
        self.diagnostics: list[Diagnostic] = []

    def error(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.diagnostics.append(Diagnostic(Severity.ERROR, code, message, span, hint))

    def remark(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.diagnostics.append(Diagnostic(Severity.REMARK, code, message, span, hint))

    def warning(self, code: str, message: str, span: Span, hint: str = "") -> None:
        self.diagnostics.append(Diagnostic(Severity.WARNING, code, message, span, hint))
