import random
from pathlib import Path

from decision_records import decision_record

from aos_deploy.runs.directory import RunDirectory
from aos_deploy.runs.record import RunRecord
from aos_protocol.messages import (
    ActionValue,
    ActivationId,
    BeliefSummary,
    Marginal,
    MissionBegun,
    MissionState,
    Outcome,
    PredictedObservation,
    SearchMade,
)
from aos_runtime.disk.journal import Journal

SKILLS = ("look", "go(to=hall)", "go(to=lab)", "pick", "put", "wait")
PREDICTED = (PredictedObservation("seen", 0.8), PredictedObservation("unseen", 0.2))
PLACES = ("hall", "lab", "yard", "office")


def write_long_run(runs: Path, steps: int, *also: Marginal, has_ended: bool = True) -> str:
    """Writes the run of a mission with so many steps, and returns its name. Each belief has `also` these.

    One that has not ended was killed.
    """
    draws = random.Random(7)
    run = RunDirectory.create(runs, "marathon", now_ns=1_700_000_000 * 10**9)
    name = run.path.name
    run.write_record(
        RunRecord(
            robot="marathon", endpoint="tcp/127.0.0.1:1", deploy_file="m.yaml", seed=1, started="", pid=1
        )
    )
    with Journal.open(run.path / "journal.db", survives_power_loss=False) as journal:
        journal.append("begun", MissionBegun(name, 1, 1, 1, "digest"))
        for step in range(1, steps + 1):
            action = draws.choice(SKILLS)
            common = {
                "action": action,
                "actions": tuple(
                    ActionValue(each, draws.gauss(4, 3), draws.randrange(2000), 0.1 * draws.random())
                    for each in SKILLS
                ),
                "predicted": PREDICTED,
                "planner": "pomcp",
                "searches": (SearchMade("pomcp", (2000,), 0, {"put": "the arm is off"}),),
                "set_aside": {"wait": "wait is left out by ana"},
            }
            skill = action.partition("(")[0]
            journal.append(
                "decision", decision_record(2 * step - 2, name, skill, belief=_belief(draws, also), **common)
            )
            outcome = Outcome(ActivationId(name, step), skill, "observed", draws.choice(("seen", "unseen")))
            journal.append(
                "decision",
                decision_record(
                    2 * step - 1, name, skill, belief=_belief(draws, also), outcome=outcome, **common
                ),
            )
        if has_ended:
            journal.append("mission", MissionState(name, "ended", steps, 0.0, "step_limit", "the step limit"))
    run.close()
    return name


def _belief(draws: random.Random, also: tuple[Marginal, ...]) -> BeliefSummary:
    marginals = list(also)
    for number in range(8):
        weights = [draws.random() for _ in PLACES]
        values = {place: weight / sum(weights) for place, weight in zip(PLACES, weights, strict=True)}
        marginals.append(Marginal(f"thing_{number}_at", values))
    return BeliefSummary(tuple(marginals), 1.0, draws.random(), 0.0, 64, True)
