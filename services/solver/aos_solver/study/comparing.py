"""The comparison of a replayed decision with the recorded one, bit for bit."""

from collections.abc import Iterator

import msgspec

from aos_protocol.messages import BeliefSummary, DecisionRecord, SearchMade
from aos_solver.child.answers.models import Plan
from aos_solver.study.replaying import Remade


class Comparison(msgspec.Struct, frozen=True):
    """A row of the journal that was compared with its replay.

    `difference` is the first thing that differs, empty where all that was compared is identical, and `cause`
    is why it may. `decides` says that the row is a decision, and `has_values` that its search was made again.
    `without` is why it was not.
    """

    row: int
    step: int
    action: str
    decides: bool
    has_belief: bool = False
    has_values: bool = False
    difference: str = ""
    cause: str = ""
    without: str = ""


def compared(remade: Remade, build_digest: str, budget_s: float | None) -> Comparison | None:
    """A decision or an outcome compared; None for other rows.

    `build_digest` is that of the replaying engine, and `budget_s` the mission's budget in time.
    """
    record = remade.said
    if not isinstance(record, DecisionRecord):
        return None
    decides = record.outcome is None
    has_belief = bool(record.belief.digest and remade.belief.digest)
    found = _difference_of_belief(record.belief, remade.belief) if has_belief else ""
    cause = "the rows before it are identical: the update, or what was drawn for it, is another one"
    without = _reason_without(record, budget_s) if decides else ""
    has_values = decides and not without
    if has_values and not found:
        found, cause = next(_differences(record, remade.plans), ("", ""))
    if found and record.build_digest and build_digest != record.build_digest:
        cause = f"the build differs: {record.build_digest[:12]} then, {build_digest[:12]} here"
    return Comparison(
        remade.row,
        record.step,
        record.action,
        decides,
        has_belief,
        has_values,
        found,
        cause if found else "",
        without,
    )


def _reason_without(record: DecisionRecord, budget_s: float | None) -> str:
    if record.chosen_by in ("retry", "operator", "script"):
        return f"it was chosen by {record.chosen_by}, and nothing was searched"
    if not record.searches:
        return "the record does not tell its searches: an earlier version of AOS wrote it"
    if record.chosen_by == "planner" and budget_s is not None:
        return f"its budget was {budget_s:g} s, in which a machine is not as quick twice"
    return ""


def _difference_of_belief(then: BeliefSummary, now: BeliefSummary) -> str:
    if then.digest == now.digest:
        return ""
    return f"the belief is {then.digest}, and {now.digest} in the replay"


def _differences(record: DecisionRecord, plans: tuple[Plan | None, ...]) -> Iterator[tuple[str, str]]:
    """The differences and their causes; what causes others comes before them."""
    for number, (made, plan) in enumerate(zip(record.searches, plans, strict=True), 1):
        if plan is None:
            continue
        which = f"search {number} of {len(record.searches)}" if len(record.searches) > 1 else "the search"
        if made.planner != plan.planner:
            yield f"{which} was by {made.planner}, and by {plan.planner} in the replay", plan.why
        if made.known != plan.known_simulations:
            yield (
                f"{which} began with {made.known} known simulations, and with {plan.known_simulations} "
                "in the replay",
                "another search, or another process of the engine, came before it",
            )
        if made.simulations != (plan.by_thread or (plan.simulations,)):
            counts = plan.by_thread or (plan.simulations,)
            yield f"{which} had {made.simulations} simulations, and {counts} in the replay", "another budget"
    decided = _decided(record.searches, plans)
    if decided is None:
        return
    why = "belief, budget and seed are the same"
    for then, now in zip(record.actions, decided.actions, strict=False):
        if then != now:
            yield f"{then.action} had {then}, and {now} in the replay", why
    if record.action != (chosen := decided.best.action):
        yield f"{record.action} was chosen, and {chosen} in the replay", why
    if record.predicted != decided.predicted:
        yield f"{record.predicted} were predicted, and {decided.predicted} in the replay", why


def _decided(searches: tuple[SearchMade, ...], plans: tuple[Plan | None, ...]) -> Plan | None:
    for made, plan in reversed(list(zip(searches, plans, strict=True))):
        if not made.is_dropped and not made.is_pondering:
            return plan
    return None
