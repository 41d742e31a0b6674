"""JUnit's XML, as continuous integration reads it: a suite for each test, a case for each claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree

import msgspec

from aos_lab.trials.claims import Verdict, asking_the_world, judge
from aos_lab.trials.files import MissionTest
from aos_lab.trials.trial import Trial


class Tested(msgspec.Struct, frozen=True, kw_only=True):
    verdicts: tuple[Verdict, ...]
    trials: tuple[Trial, ...]
    passed: bool

    @classmethod
    def of(cls, test: MissionTest, trials: tuple[Trial, ...]) -> Tested:
        """The verdicts on a test's claims."""
        by = "model" if test.by == "model" else "system"
        verdicts = tuple(
            judge(asking_the_world(claim, by, test.truth), trials, by)
            for claim in test.claims
            if claim.only in (None, by)
        )
        return cls(verdicts=verdicts, trials=trials, passed=all(verdict.is_seen for verdict in verdicts))


def verdict_text(verdict: Verdict) -> str:
    """`held in 19 of 20 missions (0.95, between 0.76 and 0.99)`."""
    if not verdict.missions:
        return "no mission was one that it is about"
    share = verdict.share
    # Then the claim wants it `surely`.
    is_unsure = not verdict.is_seen and share.value >= verdict.wanted
    where = " at the lower end; more missions may tell" if is_unsure else ""
    return (
        f"held in {verdict.held} of {verdict.missions} missions ({share.value:.2f}, "
        f"between {share.low:.2f} and {share.high:.2f}; wanted {verdict.wanted:.2f}{where})"
    )


def write_junit(path: Path, tested: Mapping[str, Tested]) -> None:
    root = ElementTree.Element("testsuites")
    for name, test in tested.items():
        failures = sum(not verdict.is_seen for verdict in test.verdicts)
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=name,
            tests=str(len(test.verdicts)),
            failures=str(failures),
            time=f"{sum(trial.seconds for trial in test.trials):.3f}",
        )
        for verdict in test.verdicts:
            case = ElementTree.SubElement(suite, "testcase", classname=name, name=verdict.says)
            if not verdict.is_seen:
                failure = ElementTree.SubElement(case, "failure", message=verdict_text(verdict))
                failure.text = "\n".join(failed_missions(verdict, test.trials))
    path.parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(root).write(path, encoding="unicode", xml_declaration=True)


def failed_missions(verdict: Verdict, trials: Sequence[Trial]) -> list[str]:
    """The missions where a claim did not hold, each with all that was done."""
    return [
        f"seed {trial.seed}, {trial.ending}: {trial.fault or ', '.join(trial.steps) or 'nothing was done'}"
        + ("; no state of the world was recorded" if verdict.asks_world and not trial.states else "")
        for trial in trials
        if trial.seed in verdict.failed_seeds
    ]
