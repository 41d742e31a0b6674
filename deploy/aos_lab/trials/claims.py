"""Claims: statements about missions that can be checked, as experiments and mission tests write them.

A pattern names steps: `pick` and `navigate(destination=corridor)` are actions, `pick > success` an action
with what came back. `*` and `?` stand for any text and any letter, ` | ` separates alternatives. A skill's
name alone means it with any parameters.
"""

from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from typing import Annotated, Any, Literal

import msgspec
from msgspec.structs import replace

from aos_lab.trials.intervals import Interval, interval_of_share
from aos_lab.trials.trial import Trial

Share = Annotated[float, msgspec.Meta(ge=0, le=1)]
Number = Annotated[int, msgspec.Meta(ge=0)]

_MODEL_SHARE, _SYSTEM_SHARE = 0.95, 0.9


class Count(msgspec.Struct, frozen=True, kw_only=True):
    """The number of a mission's steps that a pattern names."""

    step: str
    at_least: Number = 0
    at_most: Number | None = None


class Before(msgspec.Struct, frozen=True, kw_only=True):
    """The claim that before each `step` came `comes`, so many `times`, after the last step `since` if that
    is given."""

    step: str
    comes: str
    since: str | None = None
    times: Number = 1


class Around(msgspec.Struct, frozen=True, kw_only=True):
    """The claim that at each `step` the world's last state before it has the text `before`, and the one
    after it `after`."""

    step: str
    before: str | None = None
    after: str | None = None


class When(msgspec.Struct, frozen=True, kw_only=True):
    """The missions that a claim is about: what was done in them, with the words of a claim."""

    starts: tuple[str, ...] = ()
    some: str | None = None
    never: str | None = None
    order: tuple[str, ...] = ()
    endings: tuple[str, ...] = ()


class Claim(When, frozen=True, kw_only=True):
    """Says something of a mission; all its checks have to hold in at least `share` of the missions.

    `only` says by whom those missions are played. Without a share, 0.95 is wanted where the model plays and
    0.9 in a whole system, of which there are fewer missions.

    `first` and `last` are the first and the last step, `starts` the first ones. `some` step was taken,
    `never` another one. Steps of `order` were taken in this order, and those of `never_order` were not.
    `actions` are all actions, in full. `endings` are the allowed ones. `goal` says whether it was reached.

    The world is asked by texts of its truth: no state holds one of `never_state`, some state one of
    `some_state`, the one after the first step one of `first_state`, the last one one of `last_state`, and
    those around a step those of `around`. What nobody has recorded holds nothing. With `surely`, the
    interval's lower end has to reach the share.
    """

    says: str
    only: Literal["model", "system"] | None = None
    share: Share | None = None
    surely: bool = False
    when: When | None = None
    first: str | None = None
    last: str | None = None
    never_order: tuple[str, ...] = ()
    before: Before | None = None
    count: Count | None = None
    actions: tuple[str, ...] = ()
    goal: bool | None = None
    never_state: str | None = None
    some_state: str | None = None
    first_state: str | None = None
    last_state: str | None = None
    around: Around | None = None


_OF_WORLD = ("never_state", "some_state", "first_state", "last_state", "around")


class Verdict(msgspec.Struct, frozen=True, kw_only=True):
    """The result of a claim: in how many of how many missions it held, and the seeds where it did not.

    `asks_world` says that states of the world are asked for.
    """

    says: str
    held: int
    missions: int
    share: Interval
    wanted: float
    is_seen: bool
    failed_seeds: tuple[int, ...]
    asks_world: bool = False

    @property
    def word(self) -> str:
        """The word of a report for it; where no mission was one that the claim is about, there was no
        case."""
        return "seen" if self.is_seen else "not seen" if self.missions else "no case"


def usual_share(by: str) -> float:
    """The share of missions in which a claim has to hold that names none, by who plays them."""
    return _MODEL_SHARE if by == "model" else _SYSTEM_SHARE


def has_check(claim: Claim) -> bool:
    """Returns whether a claim says anything that could fail."""
    return any(getattr(claim, name) not in (None, ()) for name in _CHECKS)


def asking_the_world(claim: Claim, by: str, truth: str) -> Claim:
    """The same claim, which asks the world whether the goal was reached: a system knows its belief alone."""
    is_believed = by != "model" and truth and claim.goal and claim.last_state is None
    return replace(claim, last_state=truth) if is_believed else claim


def judge(claim: Claim, trials: Sequence[Trial], by: str = "model") -> Verdict:
    """The verdict on a claim; it is not seen where no mission is one that it is about, or where one broke."""
    about = [trial for trial in trials if trial.fault or claim.when is None or _all_hold(claim.when, trial)]
    failed = [trial.seed for trial in about if trial.fault or not _all_hold(claim, trial)]
    wanted = claim.share if claim.share is not None else usual_share(by)
    share = interval_of_share(len(about) - len(failed), len(about))
    reached = share.low if claim.surely else share.value
    return Verdict(
        says=claim.says,
        held=len(about) - len(failed),
        missions=len(about),
        share=share,
        wanted=wanted,
        is_seen=bool(about) and reached >= wanted,
        failed_seeds=tuple(failed),
        asks_world=any(getattr(claim, name) is not None for name in _OF_WORLD),
    )


def matches(pattern: str, step: str) -> bool:
    """Returns whether a pattern names a step, which is written as `action > response`."""
    return any(_one_matches(alternative.strip(), step) for alternative in pattern.split(" | "))


def _one_matches(pattern: str, step: str) -> bool:
    action, _, response = step.partition(" > ")
    wanted_action, has_response, wanted = pattern.partition(" > ")
    is_skill = "(" not in wanted_action and fnmatchcase(action.partition("(")[0], wanted_action)
    return (is_skill or fnmatchcase(action, wanted_action)) and (
        not has_response or fnmatchcase(response, wanted)
    )


def _all_hold(said: When, trial: Trial) -> bool:
    given = {name: getattr(said, name, None) for name in _CHECKS}
    return all(_CHECKS[name](said, trial) for name, value in given.items() if value not in (None, ()))


def _count(pattern: str, trial: Trial) -> int:
    return sum(matches(pattern, step) for step in trial.steps)


def _is_order(patterns: Sequence[str], trial: Trial) -> bool:
    later = iter(trial.steps)
    return all(any(matches(pattern, step) for step in later) for pattern in patterns)


def _comes_before(before: Before, trial: Trial) -> bool:
    come = 0
    for step in trial.steps:
        if matches(before.step, step) and come < before.times:
            return False
        if before.since is not None and matches(before.since, step):
            come = 0
        come += matches(before.comes, step)
    return True


def _counts(count: Count, trial: Trial) -> bool:
    number = _count(count.step, trial)
    return count.at_least <= number and (count.at_most is None or number <= count.at_most)


def _starts(patterns: Sequence[str], trial: Trial) -> bool:
    return len(trial.steps) >= len(patterns) and all(map(matches, patterns, trial.steps))


def _never_holds(pattern: str, trial: Trial) -> bool:
    """Returns whether no state has the pattern; False where states of the trial are missing."""
    return len(trial.states) >= len(trial.actions) and not _somewhere_holds(pattern, trial)


def _somewhere_holds(pattern: str, trial: Trial) -> bool:
    return any(_holds(pattern, state) for state in trial.truths.values())


def _holds(pattern: str, state: str | None) -> bool:
    return state is not None and any(alternative.strip() in state for alternative in pattern.split(" | "))


def _last_holds(pattern: str, trial: Trial) -> bool:
    truths = trial.truths
    return bool(truths) and _holds(pattern, truths[max(truths)])


def _is_around(around: Around, trial: Trial) -> bool:
    truths = trial.truths
    for number, step in enumerate(trial.steps, 1):
        if not matches(around.step, step):
            continue
        known = [earlier for earlier in truths if earlier < number]
        before = truths[max(known)] if known else None
        if around.before is not None and not _holds(around.before, before):
            return False
        if around.after is not None and not _holds(around.after, truths.get(number)):
            return False
    return True


_CHECKS: dict[str, Callable[[Any, Trial], bool]] = {
    "first": lambda claim, trial: bool(trial.steps) and matches(claim.first, trial.steps[0]),
    "last": lambda claim, trial: bool(trial.steps) and matches(claim.last, trial.steps[-1]),
    "starts": lambda claim, trial: _starts(claim.starts, trial),
    "some": lambda claim, trial: _count(claim.some, trial) > 0,
    "never": lambda claim, trial: not _count(claim.never, trial),
    "order": lambda claim, trial: _is_order(claim.order, trial),
    "never_order": lambda claim, trial: not _is_order(claim.never_order, trial),
    "before": lambda claim, trial: _comes_before(claim.before, trial),
    "count": lambda claim, trial: _counts(claim.count, trial),
    "actions": lambda claim, trial: trial.actions == claim.actions,
    "endings": lambda claim, trial: trial.ending in claim.endings,
    "goal": lambda claim, trial: trial.goal == claim.goal,
    "never_state": lambda claim, trial: _never_holds(claim.never_state, trial),
    "some_state": lambda claim, trial: _somewhere_holds(claim.some_state, trial),
    "first_state": lambda claim, trial: _holds(claim.first_state, trial.truths.get(1)),
    "last_state": lambda claim, trial: _last_holds(claim.last_state, trial),
    "around": lambda claim, trial: _is_around(claim.around, trial),
}
