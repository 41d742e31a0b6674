"""Checks of a deploy file against its documents: who serves their skills, and how long a decision takes."""

import re

from aos_deploy.deployment.reading import Deployment
from aos_deploy.printing import from_here
from aos_language.findings import Findings
from aos_language.load import with_excerpts
from aos_protocol.diagnostics import Diagnostic, Span
from aos_protocol.documents import Project
from aos_protocol.spelling import nearest

_LONG_DECISION_S = 60.0


def binding_findings(deployment: Deployment, project: Project) -> tuple[Diagnostic, ...]:
    """Returns the paths that are nearly a skill's, the skills that nobody serves, and long decisions."""
    data, name = deployment.path.read_bytes(), str(from_here(deployment.path))
    lines = data.decode().splitlines()
    findings = Findings()

    def place_of(words: str) -> Span:
        row = next((n for n, line in enumerate(lines) if re.search(rf"{re.escape(words)}(?!\w)", line)), 0)
        return Span(name, row + 1, max(lines[row].find(words), 0) + 1)

    called = {skill.mapping.activation.path for skill in project.skills}
    bound = {path for plan in deployment.adapters for path in plan.bind}
    close = {wrong: nearest(wrong, called - bound) for wrong in bound - called}
    for wrong, meant in close.items():
        if meant:
            hint = f"Did you mean `{meant}`?"
            findings.warning("AOS110", f"no skill calls {wrong}", place_of(wrong), hint)
    unserved = sorted(called - bound - {*close.values()})
    serves_all = not bound or any(plan.serves_others for plan in deployment.adapters)
    if unserved and not serves_all:  # Without `bind:` the file is for --model.
        hint = f"Add `{unserved[0]}: ADAPTER` below `bind:`, or `'*': model`"
        findings.warning("AOS807", f"no adapter serves {', '.join(unserved)}", place_of("bind:"), hint)
    if (time_s := deployment.file.solver.time_s or 0.0) >= _LONG_DECISION_S:
        hint = "A robot plans in seconds, such as 0.2"
        findings.warning("AOS801", f"each decision takes {time_s:g} s", place_of("time_s"), hint)
    return with_excerpts(findings.sorted(), {name: data})
