"""Files of claims: mission tests of users, and experiments. Everything wrong with one is found in one run."""

from functools import cache
from pathlib import Path
from typing import Annotated, Literal, TypeVar

import msgspec

from aos_deploy.deployment.typed import read_structure
from aos_deploy.deployment.yaml_source import YamlList, YamlMap, YamlNode, YamlScalar, read_yaml
from aos_deploy.played.faults import PlayedFaults
from aos_lab.trials.claim_names import ClaimNames, project_of_setting
from aos_lab.trials.claims import Claim, has_check
from aos_lab.trials.setting import Setting
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Project
from aos_protocol.errors import DeployError

Count = Annotated[int, msgspec.Meta(ge=1)]
Seed = Annotated[int, msgspec.Meta(ge=0)]


class Part(Setting, frozen=True, kw_only=True):
    """A setting, and what is claimed of its missions.

    `truth` is text that the world's last record has where the goal was reached. Where a system plays, a claim
    of `goal: true` asks for it, too.
    """

    claims: tuple[Claim, ...] = ()
    truth: str = ""


class MissionTest(Part, frozen=True, kw_only=True):
    """Missions of the seeds `first_seed` and following."""

    seeds: Count = 10
    first_seed: Seed = 1


class TestFile(msgspec.Struct, frozen=True, kw_only=True):
    """A file of mission tests, by name. `claims` are those that tests name in place of writing them."""

    aos: Literal[1]
    claims: dict[str, Claim] = {}
    tests: dict[str, MissionTest]


class ScriptedPart(Setting, frozen=True, kw_only=True):
    """Missions of a script, so many if nobody wants more."""

    missions: Count


class ScriptFile(msgspec.Struct, frozen=True, kw_only=True):
    """Scripts by name. `calibrates` are documents, as lists of bundles, by the name in the report."""

    aos: Literal[1]
    title: str
    about: str = ""
    parts: dict[str, ScriptedPart]
    calibrates: dict[str, tuple[str, ...]] = {}


class Experiment(msgspec.Struct, frozen=True, kw_only=True):
    """An experiment: parts by name, each played by the model and by the whole system.

    `counts` are patterns of steps by the name they have in the report, which counts them. `truth` is that of
    parts which give none, and `claims` those that parts name. With `optimum` the model's returns are compared
    with the best that can be had.
    """

    aos: Literal[1]
    title: str
    about: str = ""
    counts: dict[str, str] = {}
    truth: str = ""
    optimum: bool = False
    claims: dict[str, Claim] = {}
    parts: dict[str, Part]


F = TypeVar("F", TestFile, Experiment, ScriptFile)


def read_test_file(path: Path) -> TestFile:
    """The tests of a file; DeployError AOS808 with all diagnostics if it has errors."""
    return _read(path, TestFile, "tests")


def read_experiment(path: Path) -> Experiment:
    """The experiment of a file; DeployError AOS808 with all diagnostics if it has errors."""
    return _read(path, Experiment, "parts")


def read_script_file(path: Path) -> ScriptFile:
    """The scripts of a file; DeployError AOS808 with all diagnostics if it has errors."""
    return _read(path, ScriptFile, "parts")


def _read(path: Path, kind: type[F], entries: str) -> F:
    node, findings = read_yaml(path, str(path))
    _put_named_claims(node, _entry(node, entries), findings)
    file = read_structure(node, kind, findings) if node is not None else None
    if node is not None and file is not None:
        parts: dict[str, Part | ScriptedPart] = {**getattr(file, entries)}
        folder = path.resolve().parent
        project = cache(lambda deploy, bundles: project_of_setting(deploy, bundles, folder))
        for name, part in parts.items():
            where, label = _entry(_entry(node, entries), name), f"{entries}.{name}"
            if isinstance(part, Part):
                _check(part, where, findings, label)
                _check_names(part, where, findings, project(part.deploy, part.bundles))
            elif not part.script:
                span = where.span if where is not None else Span(label)
                findings.error("AOS105", f"{label} has no script", span, "Give it a list of actions")
        if not parts:
            findings.error("AOS105", f"{entries} names none", node.span)
    if file is None or findings.has_errors:
        raise DeployError(f"{path} has errors", code="AOS808", diagnostics=findings.sorted())
    return file


def _put_named_claims(node: YamlNode | None, parts: YamlNode | None, findings: Findings) -> None:
    """Puts the file's claims into the lists where parts name them."""
    shared, each = _entry(node, "claims"), parts.entries.values() if isinstance(parts, YamlMap) else ()
    known = shared.entries if isinstance(shared, YamlMap) else {}
    for part in each:
        listed = _entry(part, "claims")
        if not isinstance(part, YamlMap) or not isinstance(listed, YamlList):
            continue
        items: list[YamlNode] = []
        for item in listed.items:
            if not isinstance(item, YamlScalar):
                items.append(item)
            elif (name := str(item.value)) in known:
                items.append(known[name])
            else:
                message = f"the claim {name} is not among the `claims` of the file"
                findings.unknown(name, known, message, item.span, "Write it there", code="AOS106")
        part.entries["claims"] = YamlList(tuple(items), listed.span)


def _check(part: Part, node: YamlNode | None, findings: Findings, path: str) -> None:
    listed = _entry(node, "claims")
    items = listed.items if isinstance(listed, YamlList) else ()
    if not part.claims:
        where = node.span if node is not None else Span(path)
        findings.error("AOS105", f"{path} claims nothing", where, "Give it a list of `claims`")
    for claim, item in zip(part.claims, items, strict=False):
        is_misspelt = isinstance(item, YamlMap) and not item.entries.keys() <= {*Claim.__struct_fields__}
        if not has_check(claim) and not is_misspelt:
            hint = "Give it a check, such as first, never, order or endings"
            findings.error("AOS105", f"nothing is checked by the claim {claim.says!r}", item.span, hint)


def _check_names(part: Part, node: YamlNode | None, findings: Findings, project: Project | None) -> None:
    listed = _entry(node, "claims")
    if project is not None and isinstance(listed, YamlList):
        names = ClaimNames(project, part.by, findings)
        for claim, item in zip(part.claims, listed.items, strict=False):
            names.check(claim, item.span)
    faults = _entry(node, "faults")
    if project is not None and faults is not None and part.by == "system-model":
        try:
            PlayedFaults(part.faults).check(skill.name for skill in project.skills)
        except DeployError as error:
            findings.error("AOS106", error.message, faults.span, error.hint)


def _entry(node: YamlNode | None, key: str) -> YamlNode | None:
    return node.entries.get(key) if isinstance(node, YamlMap) else None
