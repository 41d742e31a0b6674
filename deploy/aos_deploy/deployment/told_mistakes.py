"""Findings about what stands in a deploy file or an option, and their refusal."""

from collections.abc import Iterable
from pathlib import Path

from aos_language.findings import Findings
from aos_protocol.errors import DeployError


def findings_of(sources: Iterable[str | Path]) -> Findings:
    """Findings that show the lines of these files."""
    findings = Findings()
    for source in sources:
        findings.add_source(str(source), Path(source).read_text(encoding="utf-8").splitlines())
    return findings


def refuse_errors(findings: Findings, message: str) -> None:
    """Raises DeployError AOS801 with all findings where one is an error."""
    if findings.has_errors:
        raise DeployError(message, diagnostics=findings.sorted())
