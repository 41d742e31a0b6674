"""The shares of a script's steps that come out in each way, and what that says about documents."""

from collections import Counter
from collections.abc import Iterator, Sequence

import msgspec

from aos_lab.calibration.calibrate import Calibration
from aos_lab.calibration.records import RecordedMission
from aos_lab.experiments.markdown import head, row, shown, tally
from aos_lab.experiments.results import Surroundings
from aos_lab.trials.intervals import Interval, interval_of_share


class ScriptedStep(msgspec.Struct, frozen=True, kw_only=True):
    """One step of a script in all missions: what came back, and what it changed in the world."""

    part: str
    number: int
    action: str
    responses: dict[str, Interval]
    became: dict[str, int]


class Statistics(msgspec.Struct, frozen=True, kw_only=True):
    """Everything that a report of scripts shows."""

    name: str
    title: str
    about: str
    command: str
    surroundings: Surroundings
    seeds: dict[str, str]
    broken: dict[str, int]
    steps: tuple[ScriptedStep, ...]
    calibrations: dict[str, Calibration]


def steps_of(part: str, missions: Sequence[RecordedMission]) -> Iterator[ScriptedStep]:
    """Yields the steps of whole missions of the same script."""
    for number, step in enumerate(missions[0].steps if missions else ()):
        counts = Counter(mission.steps[number].response for mission in missions)
        yield ScriptedStep(
            part=part,
            number=number + 1,
            action=step.action,
            responses={name: interval_of_share(hits, len(missions)) for name, hits in counts.most_common()},
            became=dict(Counter(_became(mission, number) for mission in missions).most_common()),
        )


def _became(mission: RecordedMission, number: int) -> str:
    """The variables that the step changed; of the first step all that are known are taken for unchanged."""
    after = dict(mission.steps[number].truth)
    before = dict(mission.steps[number - 1].truth) if number else after
    changed = (f"{name}={value}" for name, value in after.items() if before.get(name, value) != value)
    return ", ".join(changed) or "nothing"


def markdown_statistics(statistics: Statistics) -> str:
    around = statistics.surroundings
    lines = [f"# {statistics.title}", "", statistics.about.strip(), "", around.text(statistics.command), ""]
    lines += ["## What came of each step", "", *_steps(statistics), ""]
    for name, calibration in statistics.calibrations.items():
        lines += [f"## The numbers of the {name} documents", "", *_numbers(calibration), ""]
        lines += [f"Not used to its end: {remark}\n" for remark in calibration.remarks]
    lines += ["Values in brackets are the ends of 95 % intervals.", ""]
    lines += [f"Seeds of {part}: {seeds}." for part, seeds in statistics.seeds.items()]
    lines += [f"Of {part}, {number} missions broke." for part, number in statistics.broken.items() if number]
    return "\n".join(lines) + "\n"


def _steps(statistics: Statistics) -> Iterator[str]:
    yield from head("script", "step", "action", "response", "what it changed in the world")
    for step in statistics.steps:
        shares = ", ".join(f"{name} {shown(share)}" for name, share in step.responses.items())
        yield row(step.part, str(step.number), step.action, shares, tally(step.became))


def _numbers(calibration: Calibration) -> Iterator[str]:
    yield from head("place", "outcome", "count", "our world", "document", "")
    for estimate in calibration.estimates:
        for outcome in estimate.outcomes:
            verdict = "inside" if outcome.is_inside else "**outside**"
            yield row(
                f"{estimate.draw.span.file}:{estimate.draw.span.line}",
                outcome.outcome,
                f"{outcome.count:g} of {estimate.count:g}",
                shown(outcome.probability, 3) if estimate.count else "",
                f"{outcome.document:.3f}",
                verdict if estimate.count else "no record",
            )
