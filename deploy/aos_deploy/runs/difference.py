"""Two missions beside each other: their settings, and the first step that differs."""

import msgspec

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.studied import StudiedRun
from aos_protocol.errors import DeployError
from aos_protocol.messages import DecisionRecord

_OF_THE_PLACE = ("robot", "service", "endpoint", "password_file", "run_dir", "cache_dir", "policy")
"""Settings that say where a run was and not how it decided."""


class Difference(msgspec.Struct, frozen=True):
    """The differences of two missions: `settings` by name, with the values of both, and the first step.

    `step` is 0 where all steps are the same; `before` are those that are the same. `what` says what differs
    at the step.
    """

    settings: dict[str, tuple[str, str]]
    step: int = 0
    what: str = ""
    before: int = 0

    @property
    def is_any(self) -> bool:
        """Says whether the missions differ in their steps."""
        return self.step > 0


def difference(first: StudiedRun, second: StudiedRun) -> Difference:
    """Compares the journals of two missions; nothing is computed again."""
    settings = _differing(_described(first), _described(second))
    made = [studied.mission.decisions for studied in (first, second)]
    same = 0
    for then, now in zip(*made, strict=False):
        what = _difference_of_decisions(then, now) or _difference_of_outcomes(
            first.mission.outcome(then.step), second.mission.outcome(now.step)
        )
        if what:
            return Difference(settings, then.step, what, same)
        same += 1
    if len(made[0]) != len(made[1]):
        longer = "A" if len(made[0]) > len(made[1]) else "B"
        return Difference(settings, same + 1, f"only {longer} has it", same)
    return Difference(settings, before=same)


def _described(studied: StudiedRun) -> dict[str, str]:
    fields = msgspec.structs.asdict(studied.settings)
    described = {name: str(value) for name, value in fields.items() if name not in _OF_THE_PLACE}
    try:
        described["version of AOS"] = RunDirectory(studied.run).read_record().version or "an earlier one"
    except DeployError:
        described["version of AOS"] = "unknown"
    if begun := studied.mission.begun:
        described["seed"] = str(begun.seed)
        described["model"] = begun.model_digest[:12]
        described["mission parameters"] = str(begun.mission_parameters)
    if decisions := studied.mission.decisions:
        described["build"] = decisions[0].build_digest[:12] or "unknown"
    return described


def _differing(first: dict[str, str], second: dict[str, str]) -> dict[str, tuple[str, str]]:
    names = [*first, *(name for name in second if name not in first)]
    return {
        name: (first.get(name, "none"), second.get(name, "none"))
        for name in names
        if first.get(name) != second.get(name)
    }


def _difference_of_decisions(then: DecisionRecord, now: DecisionRecord) -> str:
    if then.action != now.action:
        return f"{then.action} in A, {now.action} in B"
    if then.belief.digest != now.belief.digest:
        return (
            f"both choose {then.action}, for the belief {then.belief.digest} in A, {now.belief.digest} in B"
        )
    for one, other in zip(then.actions, now.actions, strict=False):
        if one != other:
            return f"both choose {then.action}; {one.action} is worth {one.q:.6g} in A, {other.q:.6g} in B"
    return ""


def _difference_of_outcomes(then: DecisionRecord | None, now: DecisionRecord | None) -> str:
    texts = [_outcome_text(record) for record in (then, now)]
    if texts[0] == texts[1]:
        return ""
    action = next(record.action for record in (then, now) if record is not None)
    return f"{action} brought {texts[0]} in A, {texts[1]} in B"


def _outcome_text(record: DecisionRecord | None) -> str:
    if record is None or record.outcome is None:
        return "nothing yet"
    outcome = record.outcome
    numbers = f" with {outcome.numbers}" if outcome.numbers else ""
    return f"{outcome.response or outcome.status}{numbers}"
