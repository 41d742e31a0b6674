"""The mission: its phase, its beliefs, and its decisions."""

import math
from typing import Annotated, Any, Literal

import msgspec

from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project
from aos_protocol.messages.base import Message
from aos_protocol.messages.records import ChosenBy, ModelDrift, SearchMade
from aos_protocol.messages.skills import Outcome


class CheckModel(Message, frozen=True):
    """The registry's question before it accepts documents: can the solver use them, now?"""

    project: Project


class ModelCheck(Message, frozen=True):
    """The solver's answer: compile errors, or that the running mission cannot carry its belief over."""

    diagnostics: tuple[Diagnostic, ...] = ()


class StartMission(Message, frozen=True):
    """Starts the mission that the solver was configured for. A second start changes nothing.

    A system that stays begins its next mission, and refuses that while one runs (AOS515). The mission's
    `belief` at the start is the `initial` one, or with `keep` the last one of the mission before. Then `idle`
    steps of extrinsic changes pass, and the belief is conditioned on what is `given`, as expressions over
    `state` (AOS516 where that has probability 0). `values` are those of mission parameters that differ from
    the deploy file's. One `request` begins one mission, however often it is asked for.
    """

    belief: Literal["initial", "keep"] = "initial"
    given: tuple[str, ...] = ()
    idle: Annotated[int, msgspec.Meta(ge=0, le=10_000)] = 0
    values: dict[str, str] = {}
    request: str = ""


class StopMission(Message, frozen=True):
    """Cancels what moves and ends the mission as `cancelled`. Answered by its MissionState when it has ended.

    One that waits for its model does not begin, which SteeringError tells whoever has started it. The only
    mission of a system is `cancelled` then. Where no mission runs or waits, nothing changes. An empty
    `mission` is the one that does. `by` is who asks.
    """

    mission: str = ""
    reason: str = "stopped by hand"
    by: str = ""


class MissionsQuery(Message, frozen=True):
    """Asks which missions the system has run."""


class MissionEntry(Message, frozen=True):
    """One mission of a system. What it began with is as in StartMission, `seed` is its own."""

    mission: str
    number: int
    seed: int
    begun_ns: int
    belief: str = "initial"
    given: tuple[str, ...] = ()
    idle: int = 0
    values: dict[str, str] = {}
    ended_ns: int = 0
    ending: str = ""
    remark: str = ""
    steps: int = 0


class Missions(Message, frozen=True):
    """The missions of a system, the oldest first. `stays` says that others may follow."""

    entries: tuple[MissionEntry, ...]
    stays: bool = False


class MissionBegun(Message, frozen=True, omit_defaults=True):
    """The journal's row with which a solver begins a mission, or takes it up: `epoch` counts these rows.

    `revision` and `model_digest` are of the documents at this moment, `seed` is the mission's.
    `mission_parameters` are its values of all parts of mission parameters, which newer documents do not
    change. `start` is what a mission of a system that stays was asked to begin with. A mission `is_retraced`
    where it is taken up through all the models that it had; else this one has replayed its past.
    """

    mission: str
    epoch: int
    seed: int
    revision: int
    model_digest: str
    mission_parameters: dict[str, str] = {}
    start: StartMission | None = None
    is_retraced: bool = False


TakeoverWay = Literal["import", "replay", "projection"]
"""The way in which a model comes to its belief when it takes over a mission that runs."""


class ModelAdopted(Message, frozen=True):
    """The journal's row for a model that takes the place of another one, `before`, while the mission runs.

    `by` is how it came to its belief: by `import` where the state is the same, by `replay` of the mission's
    `steps`, or by `projection`. Of the replayed steps so many are `foreign`: their action or response is not
    in the new documents, and they let extrinsic changes alone act. `moved` has the variables of both models
    whose distribution is another one now, and by how much in total variation; compounds and arrays by their
    parts. `why` says what stood in the way of the ways before.
    """

    revision: int
    model_digest: str
    before: int
    by: TakeoverWay = "import"
    steps: int = 0
    foreign: int = 0
    moved: dict[str, float] = {}
    why: str = ""


class ResumeMission(Message, frozen=True):
    """Lets a mission go on that holds; one that does not is left alone. Answered by its MissionState.

    `by` is who asks.
    """

    by: str = ""


QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
"""The shares of the probability whose quantiles a marginal has."""


class Marginal(Message, frozen=True):
    """The distribution of one state variable: value text to probability, most probable first.

    Of many values only the most probable ones are told; `others` is the probability of all the rest.
    `quantiles` are the values up to which 5, 25, 50, 75 and 95 % of the probability lie. A real number with
    more than eight values has them, a whole number whose values are not all told, and nothing else.
    """

    variable: str
    values: dict[str, float]
    others: float = 0.0
    quantiles: tuple[float, ...] = ()


class EndingOdds(Message, frozen=True):
    """The chance of each ending; `over_probability` is as in BeliefSummary."""

    goal_probability: float
    failure_probability: float
    over_probability: float


class BeliefSummary(Message, frozen=True):
    """A belief for people: marginals of all variables, entropy in nats, and the chance of each ending.

    `over_probability` is that of a mission that is over and is neither a goal nor a failure.
    `states` is the number of distinct states; `effective_states` is how many of equal weight would tell as
    much. No event's probability is further than `error_bound` from what Bayes' rule gives; it is 1 where
    steps had to be sampled and nothing is certain. `is_exact`: it is a millionth at most. `cautious` has the
    chances of the endings if nothing ran that was not observed; None where nothing sets that belief apart
    from this one. `digest` is of all states with their weights, to 24 bits, of each hypothesis and of the
    cautious belief; a replay of the outcomes gives the same one. It is
    empty for particles that no replay gives.
    """

    marginals: tuple[Marginal, ...]
    entropy: float
    goal_probability: float
    failure_probability: float
    states: int
    is_exact: bool
    effective_states: float = 0.0
    error_bound: float = 0.0
    over_probability: float = 0.0
    cautious: EndingOdds | None = None
    digest: str = ""


class MissionQuery(Message, frozen=True):
    """Asks the solver where the mission is."""


class MissionState(Message, frozen=True):
    """The mission: its `phase` of waiting, compiling, planning, acting, holding, ended; how it ended.

    `ending` is one of `goal`, `over`, `failure`, `nothing_worthwhile`, `too_risky`, `step_limit`,
    `skills_failed`, `cancelled`, `fault`, or empty while it runs. The first three are what the belief holds
    for sure enough: how the world has really ended, nobody tells the robot. `remark` is one line for people.
    `epoch` counts the starts of the mission's solver, and is 0 before the mission has begun.

    A mission that does not end by itself is ended in the journal by aos-up: as `cancelled`, as `fault`, or as
    `not_started` where nothing was decided. `code` is that of the fault.

    `held_by` is who holds it, empty where nobody does: a mission in the phase `holding` without it holds for
    a skill. `left_out` are the skills and grounded actions that decisions do without, with who left them out.
    `asked` are the actions that somebody has asked for and that are still to be carried out.
    """

    mission: str
    phase: str
    step: int
    goal_probability: float
    ending: str = ""
    remark: str = ""
    revision: int = 0
    epoch: int = 0
    code: str = ""
    held_by: str = ""
    left_out: dict[str, str] = {}
    asked: tuple[str, ...] = ()


class ActionValue(Message, frozen=True):
    """The worth of one grounded action.

    `q` is an estimate of the discounted return of the next decisions, as many as the record's `horizon`. The
    first of them is the action, and each later one is planned anew. `stderr` is the standard error of the
    estimate: that of samples, and that of what the search does not know. `at_least` and `at_most` are proven
    for the belief decided on, and rounded outwards: some way of deciding is known that returns no less, and
    none returns more. None says that no such number is known. `n` is how often the search tried the action.
    """

    action: str
    q: float
    n: int
    stderr: float
    at_least: float | None = None
    at_most: float | None = None

    def is_known(self, simulations: int) -> bool:
        """Says whether `q` tells anything: a search of so many simulations, if any, has tried the action."""
        return math.isfinite(self.q) and (self.n > 0 or simulations == 0)


class PredictedObservation(Message, frozen=True):
    """A response the chosen action may bring, with its probability under the belief."""

    response: str
    probability: float


class ConstraintRisk(Message, frozen=True):
    """One constraint of the mission in a decision: `never` with more than this `probability`.

    `left` is what the decisions before have left of it, and `risk` what this one takes: the probability,
    under the belief decided on, that the chosen action's step violates the constraint. `risks` are those of
    all actions, in the order of the record's `actions`; one that risks more than is left cannot be chosen.
    Where steps cannot be enumerated, these are estimates (`is_sampled`).
    """

    never: str
    probability: float
    left: float
    risk: float
    risks: tuple[float, ...]
    is_sampled: bool = False


class DecisionRecord(Message, frozen=True):
    """One step of a mission, published twice: when decided (`outcome` is None) and when observed.

    `sequence` is dense over the mission and names the publication, `step` names the decision, from 1.
    `planning_s` is what the decision took. Of it `preparation_s` is processor time for what no budget counts:
    lists of states, their values, first bounds. `update_s` is what the belief update took after the outcome,
    and `update_effort` tells that in counts.
    `belief` is the belief decided on, or after the observation the updated one. `surprise` is
    -log P(observation | belief, action) in nats, of a density where numbers were observed; infinite surprise
    is given as `is_impossible`. `remark` says what of the outcome could not be used for the belief. `planner`
    made the decision with so many `threads`; `why` says why it was that planner and what it has found.
    `constraints` are the mission's, each with what the decision risks. The decision does without the skills
    and grounded actions that are `set_aside`, each with the reason; `actions` has none of them. With
    `is_cautious` it is for the belief in which nothing ran that was not observed. `adopted` tells of the
    model that has taken over since the decision before. `chosen_by` says who chose the action. One that an
    operator or a script has asked for was not searched for: `actions` and `planner` are empty.

    `searches` are all that were made since the decision before, in their order; where one made this decision
    it is the last that is not dropped. The engine's process had been started `engine_starts` times.
    `build_digest` is of the model's text, the engine's headers, compiler and flags: decisions repeat where it
    is the same. `drift` are the alarms that stand of this skill after the outcome: the model does not predict
    what it reports.
    """

    sequence: int
    stamp_ns: int
    mission: str
    epoch: int
    step: int
    action: str
    skill: str
    parameters: dict[str, Any]
    model_digest: str
    revision: int
    seed: int
    simulations: int
    horizon: int
    planning_s: float
    actions: tuple[ActionValue, ...]
    predicted: tuple[PredictedObservation, ...]
    belief: BeliefSummary
    outcome: Outcome | None = None
    surprise: float = 0.0
    is_impossible: bool = False
    remark: str = ""
    planner: str = ""
    why: str = ""
    threads: int = 1
    constraints: tuple[ConstraintRisk, ...] = ()
    set_aside: dict[str, str] = {}
    is_cautious: bool = False
    preparation_s: float = 0.0
    update_s: float = 0.0
    update_effort: str = ""
    adopted: ModelAdopted | None = None
    chosen_by: ChosenBy = "planner"
    searches: tuple[SearchMade, ...] = ()
    engine_starts: int = 1
    build_digest: str = ""
    drift: tuple[ModelDrift, ...] = ()

    @property
    def deciding_search(self) -> SearchMade | None:
        """The search that made the decision; None where none did."""
        made = [each for each in self.searches if not each.is_dropped and not each.is_pondering]
        return made[-1] if made else None


class HistoryQuery(Message, frozen=True):
    """Asks for the decision records with a sequence number of at least `since`, at most `limit` of them.

    With a limit of 0 there are as many as the answer's size allows. An empty `mission` is the newest one.
    """

    since: int = 0
    limit: int = 0
    mission: str = ""


class History(Message, frozen=True):
    """Decision records in order of their sequence numbers, and the mission they belong to.

    An answer is one page: where it `has_more`, the next one begins after its last record.
    """

    mission: str
    records: tuple[DecisionRecord, ...]
    has_more: bool = False
