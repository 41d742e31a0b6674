"""Uses that follow a model, or another one, for the tests of drift: `python -m tests.drift_truth`."""

import random
from collections.abc import Mapping

import msgspec

from aos_protocol.messages import (
    ActivationId,
    BeliefSummary,
    DecisionRecord,
    DriftTests,
    ModelDrift,
    Outcome,
    PredictedObservation,
)
from aos_solver.mission.rules.drift import after_use, begun, drifts

Odds = Mapping[str, float]
"""The probability of each response."""

BELIEF = BeliefSummary((), 0.0, 0.0, 0.0, 2, True)


def use(
    tests: DriftTests, skill: str, modelled: Odds, response: str
) -> tuple[DriftTests, tuple[ModelDrift, ...]]:
    decision = DecisionRecord(
        *(0, 0, "m", 1, 1, skill, skill, {}, "d", 1, 1, 0, 1, 0.0, ()),
        tuple(PredictedObservation(name, odds) for name, odds in modelled.items()),
        BELIEF,
    )
    outcome = Outcome(ActivationId("m", 1), skill, "observed", response)
    after = after_use(tests, decision, msgspec.structs.replace(decision, outcome=outcome))
    return after, drifts(tests, after, skill)


def drawn(odds: Odds, draw: random.Random) -> str:
    return draw.choices([*odds], [*odds.values()])[0]


def alarm_of(
    seed: int, modelled: Odds, real: Odds, uses: int, *, others: int = 0, right_before: int = 0
) -> ModelDrift | None:
    """The first alarm of a skill within so many uses, after some in which the model was right.

    There are as many `others`, which the model has right and which are not used.
    """
    draw = random.Random(seed)
    skills = {"pick": [*modelled], **{f"other{number}": ["yes", "no"] for number in range(others)}}
    tests = begun("d", skills)
    for number in range(right_before + uses):
        odds = modelled if number < right_before else real
        tests, alarms = use(tests, "pick", modelled, drawn(odds, draw))
        if alarms:
            return alarms[0]
    return None


def silent(seed: int, skills: Mapping[str, Odds], uses: int) -> bool:
    draw = random.Random(seed)
    tests = begun("d", {skill: [*odds] for skill, odds in skills.items()})
    for _ in range(uses):
        skill = draw.choice([*skills])
        weights = {name: odds * draw.uniform(0.2, 1.0) for name, odds in skills[skill].items()}
        modelled = {name: weight / sum(weights.values()) for name, weight in weights.items()}
        tests, alarms = use(tests, skill, modelled, drawn(modelled, draw))
        if alarms:
            return False
    return True


SKILLS: dict[str, Odds] = {
    "pick": {"taken": 0.9, "missed": 0.1},
    "look": {"left": 0.3, "right": 0.3, "nothing": 0.4},
    "go": {"arrived": 0.97, "lost": 0.02, "blocked": 0.01},
    "serve": {"delivered": 0.5, "not_delivered": 0.5},
}


def main() -> None:
    modelled, real = {"taken": 0.9, "missed": 0.1}, {"taken": 0.6, "missed": 0.4}
    for others in (0, 3, 9):
        found = [alarm_of(seed, modelled, real, 60, others=others) for seed in range(1000)]
        uses = sorted(each.uses for each in found if each is not None)
        median = uses[len(uses) // 2]
        print(f"0.9 really 0.6, {others} other skills: {len(uses)} of 1000 within 60 uses, median {median}")
    late = [alarm_of(seed, modelled, real, 60, others=3, right_before=100) for seed in range(300)]
    early = sum(each is not None and each.uses <= 100 for each in late)
    print(f"after 100 uses that were right: {sum(each is not None for each in late)} of 300, {early} before")
    quiet = sum(silent(seed, SKILLS, 500) for seed in range(1000))
    print(f"true runs of 500 uses, all skills together: {quiet} of 1000 silent")


if __name__ == "__main__":
    main()
