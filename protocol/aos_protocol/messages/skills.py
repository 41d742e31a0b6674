"""Activations: what the solver asks the middleware, and the middleware the adapters."""

from typing import Any

from aos_protocol.messages.base import Fault, Message


class ActivationId(Message, frozen=True):
    """Identifies one run of one grounded action for ever, whichever process asks for it."""

    mission: str
    step: int

    def __str__(self) -> str:
        return f"{self.mission}-{self.step}"


class Activate(Message, frozen=True):
    """The solver's request to run a grounded action.

    A repeat of an id joins what runs, or returns the stored outcome. An id stands for one skill with its
    parameters: a request that uses it for another one is refused (AOS514). `epoch` counts the starts of the
    mission's solver; a request of an older one than the newest is refused (AOS506).

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
    epoch: int = 1


class Outcome(Message, frozen=True):
    """The end of an activation: `status` is `observed`, `refused` (nothing was begun), `failed` (the robot
    reports it), or `timed_out`, `cancelled` or `unknown`, where nobody knows what the skill did.

    `response` is the observation, empty unless observed. `numbers` are what was observed beside it, by name:
    a number, or a list with null for those that are missing. Local variables are as they were when the rules
    ran, as text. `fault` says what went wrong; an observation has it where a rule has told a failure.
    `assigned` are the new low-level values that came with the response, as plain data, by the path of the
    `anyValue` from its state variable. `stopped_by` names the skill or the monitor whose `stop_when` has
    stopped it.

    `monitors` are the newest responses of the project's monitors since the outcome before, by monitor: an
    observation of the state at this outcome, however the activation ended. `monitor_faults` says of a monitor
    why its code gave none. `notices` are for people: what about the robot's data is odd for the first time.
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
    numbers: dict[str, Any] = {}
    stopped_by: str = ""
    monitors: dict[str, str] = {}
    monitor_faults: dict[str, str] = {}
    notices: tuple[str, ...] = ()


class Stray(Message, frozen=True):
    """A reply of an adapter that was not used: `kind` is `late`, `repeated` or `foreign`."""

    id: ActivationId
    path: str
    kind: str
    text: str


class MappingQuery(Message, frozen=True):
    """Asks the middleware which mappings it runs."""


class MappingState(Message, frozen=True):
    """The newest revision whose mappings run (0 before the first), its skills, and the newest one refused.

    `unavailable` are the skills that cannot be run now, each with the reason. For those in `for_good` to
    wait mends nothing, since the robot defines their interface otherwise. The adapter of those in `returning`
    has left, and `aos-up` expects it back. `announced` says of each skill
    how often an adapter has announced that it serves the skill's path. `revisions` are those whose mappings
    are kept: skills of each of them can be run by them. `stamp_ns` is when the middleware said so by the
    machine's monotonic clock, which also its successors go by, and later each time: an answer that is read
    after a newer state is known to be old by it.
    """

    revision: int
    skills: tuple[str, ...]
    refused: int = 0
    unavailable: dict[str, str] = {}
    for_good: tuple[str, ...] = ()
    returning: tuple[str, ...] = ()
    announced: dict[str, int] = {}
    revisions: tuple[int, ...] = ()
    stamp_ns: int = 0


class SkillCall(Message, frozen=True):
    """The middleware's request to an adapter. A repeat of an id joins the call that runs, or returns what it
    returned. What an id stands for, and `epoch`, are as in Activate.

    `fields` are what the abstraction mapping makes of the action. The action itself, `skill` with its
    `parameters`, is there for adapters that go by the documents, and empty in a call by hand.
    """

    id: ActivationId
    path: str
    fields: dict[str, Any]
    deadline_s: float
    skill: str = ""
    parameters: dict[str, Any] = {}
    epoch: int = 1


class SkillResult(Message, frozen=True):
    """An adapter's answer: the skill has succeeded. Whatever else happened is an error reply.

    `published` counts, by topic path, the messages sent on it since the adapter started: whoever listens has
    seen everything once it has seen that `TopicMessage.number`. Beside them `lost` were published during the
    call and never sent. An adapter that knows the observation itself gives its `response` with the `numbers`
    beside it, and the responses of `monitors` that it knows; then the mappings' rules do not run.
    """

    id: ActivationId
    fields: dict[str, Any]
    published: dict[str, int] = {}
    response: str = ""
    numbers: dict[str, Any] = {}
    monitors: dict[str, str] = {}
    lost: dict[str, int] = {}


class Cancel(Message, frozen=True):
    """Stop the call of this id; without one, whatever runs. Answered when it has stopped.

    A call that has ended already, or another one, is left alone. So is every call where `epoch` is older than
    the newest of the mission.
    """

    reason: str = ""
    id: ActivationId | None = None
    epoch: int = 1


class Cancelled(Message, frozen=True):
    """The activations that were stopped, as text."""

    ids: tuple[str, ...] = ()


class SkillProgress(Message, frozen=True):
    """The progress of a call: `state` is `accepted`, `executing`, `cancelling`, `succeeded`, `failed`,
    `timed_out` or `cancelled`; `progress` goes from 0 to 1; `text` is for people."""

    id: ActivationId
    path: str
    state: str
    progress: float = 0.0
    text: str = ""

    @property
    def goes_on(self) -> bool:
        """True until the call has ended."""
        return self.state in ("accepted", "executing", "cancelling")


class TopicMessage(Message, frozen=True):
    """Raw data of the robot: the fields of one message, numbered from 1 for each topic."""

    number: int
    fields: dict[str, Any]
