"""What is said on the bus, one section for each conversation.

Every payload is an `Envelope` whose body is one of these structures. Times are wall-clock nanoseconds for
people and journals; nothing is decided by them. Unknown fields are ignored, so that minor versions mix.
"""

from __future__ import annotations

from typing import Any

import msgspec

from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project

__all__ = [
    "ActionValue",
    "Activate",
    "ActivationId",
    "BeliefSummary",
    "BundleReport",
    "Cancel",
    "Cancelled",
    "Catalogue",
    "CatalogueEntry",
    "CatalogueQuery",
    "CheckModel",
    "DecisionRecord",
    "Envelope",
    "Fault",
    "History",
    "HistoryQuery",
    "MappingQuery",
    "MappingState",
    "Marginal",
    "MissionQuery",
    "MissionState",
    "ModelCheck",
    "Outcome",
    "PredictedObservation",
    "ProjectQuery",
    "ProjectRevision",
    "PushBundle",
    "RemoveDocuments",
    "RevisionEntry",
    "Revisions",
    "RevisionsQuery",
    "SkillCall",
    "SkillResult",
    "StartMission",
    "TopicMessage",
]


class Message(msgspec.Struct, frozen=True, omit_defaults=True):
    """Base of every structure on the bus."""


class Envelope(Message, frozen=True):
    """Around every payload. `version` is major.minor; another major is refused. `body` is encoded apart."""

    version: str
    stamp_ns: int
    sender: str
    body: msgspec.Raw


class Fault(Message, frozen=True):
    """An error reply."""

    code: str
    message: str
    hint: str = ""
    diagnostics: tuple[Diagnostic, ...] = ()


# --- bundles -------------------------------------------------------------------------------------------


class PushBundle(Message, frozen=True):
    """A bundle for the registry: file names, relative and flat, with their bytes. `source` is for people."""

    files: dict[str, bytes]
    source: str = ""


class BundleReport(Message, frozen=True):
    """What became of a bundle. `revision` is the project's revision now; 0 if it was never accepted."""

    project: str
    is_accepted: bool
    revision: int
    diagnostics: tuple[Diagnostic, ...] = ()
    added: tuple[str, ...] = ()
    changed: tuple[str, ...] = ()
    source: str = ""
    removed: tuple[str, ...] = ()


class RemoveDocuments(Message, frozen=True):
    """Asks the registry to give up a skill of a project, or with no skill named the whole project.

    Answered by a BundleReport. A mission that runs keeps the model it has until a revision follows.
    """

    project: str
    skill: str = ""


class RevisionsQuery(Message, frozen=True):
    """Asks for all revisions of a project; an empty name asks for the only one there is."""

    project: str = ""


class RevisionEntry(Message, frozen=True):
    """One revision. The names of files tell it from the one before; a removed project has no skills.

    `versions` gives the version of each file that declares one.
    """

    revision: int
    digest: str
    stored_ns: int
    skills: tuple[str, ...]
    added: tuple[str, ...]
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    versions: dict[str, str] = {}


class Revisions(Message, frozen=True):
    """A project's revisions, the oldest first."""

    project: str
    entries: tuple[RevisionEntry, ...]


class ProjectQuery(Message, frozen=True):
    """Asks for a revision of a project, 0 for the current one; an empty name asks for the only project."""

    project: str = ""
    revision: int = 0


class ProjectRevision(Message, frozen=True):
    """The documents of a project as they stand, checked. `digest` is over the source files."""

    revision: int
    digest: str
    project: Project


class CatalogueQuery(Message, frozen=True):
    """Asks what the catalogue holds."""


class CatalogueEntry(Message, frozen=True):
    """One project of the catalogue."""

    project: str
    revision: int
    digest: str
    stored_ns: int
    skills: tuple[str, ...]


class Catalogue(Message, frozen=True):
    """The catalogue's projects, by name."""

    entries: tuple[CatalogueEntry, ...]


# --- mission -------------------------------------------------------------------------------------------


class CheckModel(Message, frozen=True):
    """The registry's question before it accepts documents: can the solver use them, now?"""

    project: Project


class ModelCheck(Message, frozen=True):
    """The solver's answer: compile errors, or that the running mission cannot carry its belief over."""

    diagnostics: tuple[Diagnostic, ...] = ()


class StartMission(Message, frozen=True):
    """Starts the mission that the solver was configured for. A second start changes nothing."""


class Marginal(Message, frozen=True):
    """The distribution of one state variable: value text to probability, most probable first.

    Of many values only the most probable ones are told; `others` is the probability of all the rest.
    """

    variable: str
    values: dict[str, float]
    others: float = 0.0


class BeliefSummary(Message, frozen=True):
    """A belief for people: marginals of all variables, entropy in nats, and the chance of each ending.

    `states` is the number of distinct states; `effective_states` is how many of equal weight would tell as
    much. No event's probability is further than `error_bound` from what Bayes' rule gives: 0 where the belief
    is exact, 1 where steps had to be sampled and nothing is certain.
    """

    marginals: tuple[Marginal, ...]
    entropy: float
    goal_probability: float
    failure_probability: float
    states: int
    is_exact: bool
    effective_states: float = 0.0
    error_bound: float = 0.0


class MissionQuery(Message, frozen=True):
    """Asks the solver where the mission is."""


class MissionState(Message, frozen=True):
    """Where the mission is: a `phase` of waiting, building, planning, acting, ended; and how it ended.

    `ending` is one of `goal`, `failure`, `nothing_worthwhile`, `step_limit`, `cancelled`, `fault`, or empty
    while it runs. `remark` is one line for people.
    """

    mission: str
    phase: str
    step: int
    goal_probability: float
    ending: str = ""
    remark: str = ""
    revision: int = 0


class ActivationId(Message, frozen=True):
    """Identifies one run of one grounded action for ever; ordered by epoch and step within a mission."""

    mission: str
    epoch: int
    step: int

    def __str__(self) -> str:
        return f"{self.mission}-{self.epoch}-{self.step}"


class ActionValue(Message, frozen=True):
    """What the search found about one grounded action: mean return, visits, standard error of the mean."""

    action: str
    q: float
    n: int
    stderr: float


class PredictedObservation(Message, frozen=True):
    """A response the chosen action may bring, with its probability under the belief."""

    response: str
    probability: float


class DecisionRecord(Message, frozen=True):
    """One step of a mission, published twice: when decided (`outcome` is None) and when observed.

    `sequence` is dense over the mission and names the publication, `step` names the decision, from 1.
    `belief` is the belief decided on, or after the observation the updated one. `surprise` is
    -log P(observation | belief, action) in nats; infinite surprise is given as `is_impossible`. `remark` says
    what of the outcome could not be used for the belief.
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


class HistoryQuery(Message, frozen=True):
    """Asks for the decision records with a sequence number of at least `since`."""

    since: int = 0


class History(Message, frozen=True):
    """Decision records in order of their sequence numbers, and the mission they belong to."""

    mission: str
    records: tuple[DecisionRecord, ...]


# --- skills --------------------------------------------------------------------------------------------


class Activate(Message, frozen=True):
    """The solver's request to run a grounded action. A repeat of an ended id returns the stored outcome.

    Parameter values are plain data: numbers, bools, strings (enum values by name), dicts for compounds.
    `deadline_s` bounds the whole activation. `revision` is that of the model which decided, so that the
    observation is one of that model's; 0 takes the newest. `variables` names the state variables that
    parameters stand for.
    """

    id: ActivationId
    skill: str
    parameters: dict[str, Any]
    deadline_s: float
    revision: int = 0
    variables: dict[str, str] = {}


class Outcome(Message, frozen=True):
    """How an activation ended: `status` is `observed`, `failed`, `timed_out`, `cancelled` or `unknown`.

    `response` is the observation, empty unless observed. Local variables are as they were when the rules
    ran, as text. `fault` says what went wrong. `assigned` are the new low-level values that came with the
    response, as plain data, by the path of the `anyValue` from its state variable.
    """

    id: ActivationId
    skill: str
    status: str
    response: str = ""
    local_variables: dict[str, str] = {}
    started_ns: int = 0
    ended_ns: int = 0
    fault: Fault | None = None
    assigned: dict[str, Any] = {}


class MappingQuery(Message, frozen=True):
    """Asks the middleware which mappings it runs."""


class MappingState(Message, frozen=True):
    """The newest revision whose mappings run (0 before the first), its skills, and the newest one refused."""

    revision: int
    skills: tuple[str, ...]
    refused: int = 0


class SkillCall(Message, frozen=True):
    """The middleware's request to an adapter. A repeat of an id returns what the first call returned."""

    id: ActivationId
    path: str
    fields: dict[str, Any]
    deadline_s: float


class SkillResult(Message, frozen=True):
    """An adapter's answer. `published` counts, by topic path, the messages sent on it since the adapter
    started: whoever listens has seen everything once it has seen that `TopicMessage.number`.
    """

    id: ActivationId
    fields: dict[str, Any]
    published: dict[str, int] = {}


class Cancel(Message, frozen=True):
    """Stop whatever moves."""

    reason: str = ""


class Cancelled(Message, frozen=True):
    """The activations that were stopped, as text."""

    ids: tuple[str, ...] = ()


class TopicMessage(Message, frozen=True):
    """Raw data of the robot: the fields of one message, numbered from 1 for each topic."""

    number: int
    fields: dict[str, Any]
