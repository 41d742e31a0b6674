"""The abstraction mapping (AM): from parameters to the call, and from what happened to the observation."""

from collections.abc import Mapping

import msgspec

from aos_protocol.diagnostics import Span
from aos_protocol.documents.code import Snippet
from aos_protocol.older_python import StrEnum


class Import(msgspec.Struct, frozen=True):
    """`from module import names`, or `import names` where `module` is empty."""

    module: str
    names: tuple[str, ...]
    span: Span


class LowLevelAssignment(msgspec.Struct, frozen=True):
    """Gives the `anyValue` at `path` a new low-level value, a Python expression over local variables.

    `path` is `parameter.field`, or starts with a state variable.
    """

    path: str
    value: Snippet
    span: Span


class ResponseRule(msgspec.Struct, frozen=True):
    """Gives `response` when `condition`, a Python expression over local variables, holds; the first wins.

    With the response come its `assignments`.
    """

    response: str
    condition: Snippet | None
    span: Span
    assignments: tuple[LowLevelAssignment, ...] = ()


class LocalSource(StrEnum):
    """The sources of a local variable's value."""

    PARAMETER = "parameter"
    SERVICE_RESPONSE = "service_response"
    TOPIC = "topic"


class LocalVariable(msgspec.Struct, frozen=True):
    """A value the rules and the activation can use.

    PARAMETER: `parameter_path` is `parameter` or `parameter.field`. SERVICE_RESPONSE: `code` assigns the
    variable from `__input`. TOPIC: `code` is a function body over `__input` that returns the new value;
    `initial_value` is a Python expression, evaluated anew for each activation. `source_span` is where the
    parameter path or the topic stands.
    """

    name: str
    source: LocalSource
    span: Span
    type: str = ""
    parameter_path: str = ""
    topic: str = ""
    message_type: str = ""
    initial_value: Snippet | None = None
    code: Snippet | None = None
    imports: tuple[Import, ...] = ()
    is_heavy: bool = False
    source_span: Span | None = None


class ActivationField(msgspec.Struct, frozen=True):
    """One field of the request: its value is a Python expression over local variables."""

    name: str
    value: Snippet


ACTIVATION_KINDS: Mapping[str, str] = {
    "ros_service": "RosService",
    "ros_action": "RosAction",
    "skill": "Skill",
}
"""The kinds of activation with their words in JSON; `ros_action` and `skill` are ours.

Those of ROS name the type of what they call. Whatever the kind, the path's adapter is called.
"""


class Activation(msgspec.Struct, frozen=True):
    """The way to run the skill: the kind (one of `ACTIVATION_KINDS`), the path, the request's fields."""

    kind: str
    path: str
    span: Span
    service_type: str = ""
    fields: tuple[ActivationField, ...] = ()
    imports: tuple[Import, ...] = ()
    max_duration_s: float | None = None


DEFAULT_RESPONSE = "DefaultObservation"
"""This response comes back where nothing says it: of a model, and of a mapping without rules."""

NO_ACTIVATION = Activation("monitor", "", Span(""))
"""The activation of a monitor's mapping, which calls nothing."""


class AbstractionMapping(msgspec.Struct, frozen=True):
    """An abstraction mapping (AM): from parameters to the call, and from what happened to the observation.

    With `response_variable` the observation is the text of that local variable and the rules do not count.
    `stop_when` is a Python expression over local variables. It is evaluated with each topic message while the
    skill runs, and the first time it is True the skill is cancelled. One that `is_derived` is written
    nowhere: AOS made it from the skill document, where its places are.

    One of a `monitor` belongs to no skill, and calls nothing: its activation is `NO_ACTIVATION`. It is at
    work during the whole mission, its responses are explained by the environment's monitor of this name, and
    its `stop_when` stops whatever runs.
    """

    project: str
    name: str
    span: Span
    activation: Activation
    rules: tuple[ResponseRule, ...] = ()
    response_variable: str = ""
    local_variables: tuple[LocalVariable, ...] = ()
    response_variable_span: Span | None = None
    is_derived: bool = False
    stop_when: Snippet | None = None
    monitor: str = ""

    @property
    def imports(self) -> tuple[Import, ...]:
        """The imports of the activation and of all local variables."""
        return self.activation.imports + tuple(one for each in self.local_variables for one in each.imports)
