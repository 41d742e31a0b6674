"""Jobs for robots with a broken skill, as documents: stages, skills that overlap, sensors that err.

A job is over, with its goal, after its last stage. Each stage has one skill or two that get through it with
some probability, and that tell whether they did, tell it badly, or tell nothing. At one stage a thing has to
be found first. Sensors tell the stage, or where the thing is.
"""

import dataclasses
import random
from collections.abc import Sequence
from typing import Literal

Fault = Literal["fails", "is_lost", "talks_nonsense"]

FAULTS: Sequence[Fault] = ("fails", "is_lost", "talks_nonsense")

Telling = Literal["surely", "badly", "not"]

PLACES = ("Near", "Far", "Away")
HORIZON = 10


@dataclasses.dataclass(frozen=True)
class _Skill:
    name: str
    document: str
    responses: Sequence[str]
    purpose: str
    """The purpose that it is good for; two of the same purpose can stand in for one another."""

    parameter: str = ""


@dataclasses.dataclass(frozen=True)
class Job:
    """A robot's documents, and how the skill that breaks is broken.

    `did_run` says whether what is lost had its effect. `nonsense` is a response that the model never gives:
    one that the mapping knows, or one of no document.
    """

    name: str
    environment: str
    skills: Sequence[_Skill]
    fault: Fault
    did_run: bool
    nonsense: str

    @property
    def files(self) -> dict[str, str]:
        return self._with(self.skills)

    def spare(self, broken: str) -> dict[str, str] | None:
        """The bundle without a skill; None where it alone gets through some stage, or tells something."""
        working = [skill for skill in self.skills if skill.name != broken]
        suffices = {skill.purpose for skill in working} == {skill.purpose for skill in self.skills}
        return self._with(working) if suffices else None

    def _with(self, skills: Sequence[_Skill]) -> dict[str, str]:
        files = {"job.ef": self.environment}
        for skill in skills:
            files[f"{skill.name}.sd"] = skill.document
            files[f"{skill.name}.am"] = _mapping(skill)
        return files


def job(seed: int) -> Job:
    source = random.Random(f"jobs/{seed}")
    stages = source.randint(1, 3)
    found_at = source.choice((-1, *range(stages)))
    places = source.randint(2, 3)
    skills = [
        _worker(source, f"{kind}{stage}", stage, finds=stage == found_at)
        for stage in range(stages)
        for kind in ("do", "also_do")[: source.choice((1, 2, 2))]
    ]
    skills += [_stage_sensor(source, f"check{i}", stages) for i in range(source.choice((1, 2, 2)))]
    if found_at >= 0:
        skills += [_place_sensor(source, f"look{i}", places) for i in range(source.choice((1, 2, 2)))]
    return Job(
        f"jobs/{seed}",
        _environment(source, stages, places, found_at),
        skills,
        FAULTS[seed % len(FAULTS)],
        did_run=source.random() < 0.5,
        nonsense=source.choice(("never_said", "of_no_document")),
    )


def _environment(source: random.Random, stages: int, places: int, found_at: int) -> str:
    prize = source.choice((1, 20, 60))
    names = PLACES[:places]
    sections = [
        "project: job",
        f"horizon: {HORIZON}",
        f"discount: {source.choice((0.95, 0.98, 0.999))}",
        f"define_type: Place\nenum_members: {', '.join(names)}",
        "state_variable: int stage\ncode:\nstate.stage = 0;",
        "state_variable: Place thing_at\ncode:\nstate.thing_at = Near;",
    ]
    if found_at >= 0:
        sections += [
            f"action_parameter: Place {name.lower()}_place\ncode:\nstate.{name.lower()}_place = {name};"
            for name in names
        ]
        weights = {2: "0.5, 0.5", 3: "0.5, 0.25, 0.25"}[places]
        sections.append(f"initial_belief:\nstate.thing_at = AOS.SampleDiscrete(Place, {{{weights}}});")
    is_done = f"if (state.stage == {stages}) {{ __reward = {prize}; __isGoalState = true; }}"
    sections.append(f"reward_code:\n{is_done}")
    return "\n\n".join(sections) + "\n"


def _worker(source: random.Random, name: str, stage: int, *, finds: bool) -> _Skill:
    """Gets through one stage; where it has to find the thing, only at the right place."""
    success = source.choice((0.6, 0.8, 0.95))
    cost = source.choice((1, 2, 3))
    telling: Telling = source.choice(("surely", "surely", "badly", "not"))
    condition = f"state.stage == {stage}" + (" && state.thing_at == place" if finds else "")
    lines = [
        f"bool works = {condition} && AOS.Bernoulli({success});",
        f"if (works) {{ state__.stage = {stage + 1}; }}",
        f"__reward = -{cost};",
    ]
    if telling == "surely":
        lines.append("__moduleResponse = works ? done : not_done;")
    elif telling == "badly":
        lines.append(
            f"__moduleResponse = AOS.Bernoulli({source.choice((0.75, 0.9))}) == works ? done : not_done;"
        )
    else:
        lines.append("__moduleResponse = finished;")
    responses = ("finished",) if telling == "not" else ("done", "not_done")
    parameter = "place" if finds else ""
    return _Skill(name, _skill(lines, parameter), responses, f"stage {stage}", parameter)


def _stage_sensor(source: random.Random, name: str, stages: int) -> _Skill:
    accuracy = source.choice((0.8, 0.9, 0.97))
    responses = [f"stage_{stage}" for stage in range(stages + 1)]
    lines = [
        f"bool sees = AOS.Bernoulli({accuracy});",
        f"int seen = sees ? state.stage : (state.stage + 1) % {stages + 1};",
        *_one_of(responses),
        f"__reward = -{source.choice((1, 2))};",
    ]
    return _Skill(name, _skill(lines, ""), responses, "tells the stage")


def _place_sensor(source: random.Random, name: str, places: int) -> _Skill:
    accuracy = source.choice((0.7, 0.85, 0.97))
    responses = [f"at_{place.lower()}" for place in PLACES[:places]]
    lines = [
        f"bool sees = AOS.Bernoulli({accuracy});",
        f"int seen = sees ? (int)state.thing_at : ((int)state.thing_at + 1) % {places};",
        *_one_of(responses),
        f"__reward = -{source.choice((1, 2))};",
    ]
    return _Skill(name, _skill(lines, ""), responses, "tells the place")


def _one_of(responses: Sequence[str]) -> list[str]:
    lines = [f"__moduleResponse = {responses[0]};"]
    return lines + [
        f"if (seen == {number}) {{ __moduleResponse = {response}; }}"
        for number, response in enumerate(responses)
        if number
    ]


def _skill(lines: Sequence[str], parameter: str) -> str:
    head = ["project: job", *([f"parameter: Place {parameter}"] if parameter else []), "", "dynamic_model:"]
    return "\n".join([*head, *lines, ""])


def _mapping(skill: _Skill) -> str:
    sections = ["project: job"]
    sections += [
        f'response: {name}\nresponse_rule: said == "{name}"' for name in (*skill.responses, "never_said")
    ]
    sections.append(f"module_activation: skill\npath: /{skill.name}")
    if skill.parameter:
        sections[-1] += f"\nparameter: {skill.parameter}\ncode:\n{skill.parameter}"
        sections.append(f"local_variable: {skill.parameter}\naction_parameter: {skill.parameter}")
    sections.append(
        "local_variable: said\ntype: string\nfrom_ros_service_response: true\ncode:\nsaid = __input.said"
    )
    return "\n\n".join(sections) + "\n"
