"""Names in claims that no mission can have: skills, parameters, responses and state variables of no document.

A claim that something never happens would hold because of them, whatever the robot does.
"""

import re
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from msgspec.structs import replace

from aos_deploy.bundles.files import project_of
from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.deployment.typed import known_names
from aos_lab.trials.claims import Claim, When
from aos_lab.trials.trial import NOTHING_OBSERVED
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import DEFAULT_RESPONSE, Project, Skill
from aos_protocol.errors import AosError

_WILD = re.compile(r"[*?\[]")
_ARGUMENT = re.compile(r"(?:^|, )(\w+)=([^,()]*)")
_BRACES = re.compile(r"\{[^{}]*\}")
_STATE = re.compile(r"([A-Za-z_]\w*)(?:\[[^\]]*\]|\.\w+)*=(\w*)")


def project_of_setting(deploy: str, bundles: tuple[str, ...], folder: Path) -> Project | None:
    """The documents that missions of a setting may have, also those that are left out at first. Without
    `bundles` they are the deploy file's.

    It is None where others may come, and where they have mistakes, which whoever plays them tells.
    """
    try:
        deployment = read_deploy_file(folder / deploy)
        if deployment.watch is not None:
            return None
        paths = tuple(folder / bundle for bundle in bundles) or deployment.bundles
        file = replace(deployment.file, leave_out=())
        return project_of(replace(deployment, bundles=paths, file=file, constraints=(), mission_values=()))
    except (AosError, OSError):
        return None


class ClaimNames:
    """Looks for such names. States are looked at where the model plays and their text is its own."""

    def __init__(self, project: Project, by: str, findings: Findings) -> None:
        self._skills = {skill.model.name: skill for skill in project.skills}
        self._environment = project.environment
        self._enums = {enum.name: enum.values for enum in project.environment.enums}
        self._declared = [each for each in project.environment.variables if each.is_parameter_value]
        self._knows_states = by == "model" and not project.environment.print_state
        self._findings = findings

    def check(self, claim: Claim, where: Span) -> None:
        """Adds an error for each such name in a claim at `where`."""
        for pattern in [*_patterns(claim), *(_patterns(claim.when) if claim.when is not None else ())]:
            for alternative in pattern.split(" | "):
                self._check_step(alternative.strip(), where)
        for state in _states(claim) if self._knows_states else ():
            for alternative in state.split(" | "):
                self._check_state(alternative.strip(), where)

    def _check_step(self, pattern: str, where: Span) -> None:
        action, has_response, response = pattern.partition(" > ")
        name, has_arguments, arguments = action.partition("(")
        skills = [skill for known, skill in self._skills.items() if _may_be(name, known)]
        if not skills:
            message = f"a claim names the skill {name}, which no document describes"
            self._findings.unknown(name, self._skills, message, where, known_names(self._skills))
            return
        if has_arguments:
            self._check_arguments(skills, arguments, where)
        if has_response and response != NOTHING_OBSERVED:
            self._check_response(skills, response, where)

    def _check_arguments(self, skills: list[Skill], arguments: str, where: Span) -> None:
        while (outside := _BRACES.sub("", arguments)) != arguments:
            arguments = outside
        known = dict.fromkeys(parameter.name for skill in skills for parameter in skill.model.parameters)
        for name, value in _ARGUMENT.findall(arguments):
            if name not in known:
                message = (
                    f"a claim names the parameter {name} of {_named(skills)}, which has none of that name"
                )
                self._findings.unknown(name, known, message, where, known_names(known))
                continue
            values = self._values(skills, name)
            if value and values and not any(fnmatchcase(each, value) for each in values):
                message = f"a claim names the value {value} of {name}, which it never has"
                self._findings.unknown(value, values, message, where, known_names(values))

    def _values(self, skills: list[Skill], name: str) -> dict[str, None]:
        """All values that a parameter of these skills may have; none where code lists them."""
        known: dict[str, None] = {}
        for skill in skills:
            for parameter in skill.model.parameters:
                values = self._enums.get(parameter.type, ())
                if parameter.name == name and skill.model.possible_parameters and not values:
                    return {}
                declared = [each.name for each in self._declared if each.type == parameter.type]
                known |= dict.fromkeys([*declared, *values]) if parameter.name == name else {}
        return known

    def _check_response(self, skills: list[Skill], response: str, where: Span) -> None:
        if any(skill.mapping.response_variable for skill in skills):
            return
        known = dict.fromkeys(rule.response for skill in skills for rule in skill.mapping.rules)
        known[DEFAULT_RESPONSE] = None
        if not any(fnmatchcase(each, response) for each in known):
            message = f"a claim names the response {response} of {_named(skills)}, which never gives it"
            self._findings.unknown(response, known, message, where, known_names(known))

    def _check_state(self, text: str, where: Span) -> None:
        """Text of a state that begins with a name and an equals sign; the name may be the end of one."""
        found = _STATE.match(text)
        if found is None:
            return
        root, value = found.groups()
        types = {variable.name: variable.type for variable in self._environment.variables}
        fields = {field.name for compound in self._environment.compounds for field in compound.fields}
        known = dict.fromkeys([*types, *sorted(fields), "world_ending"])
        if not any(name.endswith(root) for name in known):
            message = f"a claim names the state variable {root}, which no document declares"
            self._findings.unknown(root, known, message, where, known_names(types))
        elif found.end(1) + 1 + len(value) == len(text) and root not in fields:
            values = self._enums.get(types.get(root, ""), ())
            if values and not any(each.startswith(value) for each in values):
                message = f"a claim names the value {value} of {root}, which it never has"
                self._findings.unknown(value, values, message, where, known_names(values))


def _patterns(said: When) -> Iterator[str]:
    for name in ("first", "last", "some", "never"):
        yield from [pattern] if (pattern := getattr(said, name, None)) is not None else []
    for name in ("starts", "order", "never_order", "actions"):
        yield from getattr(said, name, ())
    if isinstance(said, Claim):
        before, count, around = said.before, said.count, said.around
        yield from [before.step, before.comes] if before is not None else []
        yield from [before.since] if before is not None and before.since is not None else []
        yield from [count.step] if count is not None else []
        yield from [around.step] if around is not None else []


def _states(claim: Claim) -> list[str]:
    around = (claim.around.before, claim.around.after) if claim.around is not None else ()
    texts = (claim.never_state, claim.some_state, claim.first_state, claim.last_state, *around)
    return [text for text in texts if text is not None]


def _may_be(pattern: str, skill: str) -> bool:
    """Returns whether a pattern may name a skill; a wildcard may stand for the bracket, too."""
    wild = _WILD.search(pattern)
    if wild is None:
        return pattern == skill
    begin = pattern[: wild.start()]
    return skill.startswith(begin) or begin.startswith(skill)


def _named(skills: list[Skill]) -> str:
    return " or ".join(skill.model.name for skill in skills)
