"""The errors that cross the bus, and the table of codes.

The code crosses the bus, the class stays local. Whoever must tell situations apart catches their classes, and
compares no codes:

    AosError
      DocumentError   AOS1xx  a document cannot be read, or documents contradict each other
      ModelError      AOS2xx  model code does not compile, crashes, hangs
                      CodeFaultError (EndlessCodeError), IntractableError
      PlanningError   AOS3xx  no decision, impossible observation
      MappingError    AOS4xx  an abstraction mapping raised, or no rule matched
      SkillError      AOS5xx  a skill is unknown, refused, timed out, lost
                      MissionRunsError, SteeringError
      BusError        AOS6xx  no answer, late answer, malformed message:
                      LateAnswerError, NobodyAnswersError, LostAnswerError
      StorageError    AOS7xx  journal or catalogue
      DeployError     AOS8xx  deploy file, start-up, supervision
      GatewayError    AOS9xx  a request over HTTP, or a command, that cannot be answered

A user's mistakes are collected as diagnostics; an AosError may carry them.
"""

import sys

from aos_protocol.diagnostics import Diagnostic, render
from aos_protocol.spelling import sendable_text, shortened

CODES: dict[str, str] = {
    "AOS101": "the file cannot be read",
    "AOS102": "unknown key or section",
    "AOS103": "the same key or section twice",
    "AOS104": "the file is not well-formed",
    "AOS105": "a required key or section is missing",
    "AOS106": "a value has the wrong type",
    "AOS107": "this file is not an AOS document",
    "AOS108": "the snippet cannot be placed in a function",
    "AOS110": "unknown name",
    "AOS111": "two documents of one name",
    "AOS112": "the new documents do not fit the running mission",
    "AOS113": "documents of different projects",
    "AOS114": "a skill or a monitor has one half only; a remark where the other is derived",
    "AOS115": "no environment document",
    "AOS116": "a response that the abstraction mapping never gives",
    "AOS117": "a response that the skill document never produces",
    "AOS118": "a rule that can never fire",
    "AOS119": "a skill without grounded actions",
    "AOS120": "the bundle is refused",
    "AOS121": "the abstraction mapping's Python is not valid",
    "AOS122": "weights are wrong",
    "AOS123": "the wrong copy of the state is written or read",
    "AOS124": "a construct that is not supported yet",
    "AOS125": "a repeated section, the last one counts",
    "AOS126": "a name that cannot be used",
    "AOS127": "a tolerated spelling",
    "AOS128": "a constant is written",
    "AOS129": "a version that is not higher",
    "AOS130": "the other dialect cannot say this exactly",
    "AOS131": "a precondition that is never met",
    "AOS132": "a goal that nothing leads to",
    "AOS133": "a variable that nothing uses, or a list without objects",
    "AOS134": "a local variable that tells the state",
    "AOS136": "a reported number that the abstraction mapping does not give",
    "AOS137": "an ending that its reward decides",
    "AOS138": "`__observed` is used other than to report a draw",
    "AOS139": "no ending is a goal",
    "AOS140": "a parameter that the abstraction mapping does not pass on",
    "AOS141": "a default that sets another variable",
    "AOS142": "a constraint, or what is given at the start of a mission, cannot be used",
    "AOS143": "a variable of model code that is read without a value",
    "AOS145": "shared code that is no constant, function, enum or name of a type",
    "AOS146": "a mission parameter that the documents do not have, or a value that it cannot have",
    "AOS147": "a precondition whose violation costs nothing, or earns something",
    "AOS148": "a state that cannot be drawn",
    "AOS149": "a comparison that is none, or does nothing",
    "AOS150": "an initial state in which the mission is over",
    "AOS201": "the model's C++ does not compile",
    "AOS202": "the compiler hit a limit",
    "AOS203": "no C++ compiler",
    "AOS210": "model code crashed",
    "AOS211": "model code did not finish",
    "AOS213": "the engine ended unexpectedly",
    "AOS214": "a reward that is no number, or too large",
    "AOS215": "a model fault: an index, a weight list or a container limit",
    "AOS216": "bounds that contradict each other; please report it",
    "AOS217": "the engine failed outside of the documents' code; please report it",
    "AOS220": "exact evaluation is not tractable",
    "AOS302": "every state of the belief is terminal",
    "AOS303": "every action risks more than the mission's constraints allow",
    "AOS320": "a model that cannot be solved before the mission",
    "AOS321": "a policy that cannot be read",
    "AOS322": "a policy for another model",
    "AOS401": "abstraction mapping code raised",
    "AOS402": "no response rule matched",
    "AOS403": "abstraction mapping code did not finish",
    "AOS501": "there is no such skill, action, variable, step or mission",
    "AOS502": "the adapter refused the call",
    "AOS503": "the skill did not answer in time",
    "AOS504": "the outcome of the activation is unknown",
    "AOS505": "no adapter answers",
    "AOS506": "a stale mission epoch",
    "AOS507": "the skill was cancelled",
    "AOS508": "a message of the robot cannot be read",
    "AOS509": "the robot defines an interface differently",
    "AOS510": "the skill failed",
    "AOS511": "two adapters serve one path",
    "AOS512": "a skill may still be moving",
    "AOS513": "the mission held for too long",
    "AOS514": "the id of an activation was used for another one",
    "AOS515": "a mission runs already",
    "AOS516": "a mission cannot begin with this belief",
    "AOS517": "a mission cannot be steered so",
    "AOS518": "an action that somebody asked for is refused",
    "AOS530": "a mission that cannot be studied so",
    "AOS601": "no answer in time",
    "AOS602": "a malformed message",
    "AOS603": "another protocol version",
    "AOS604": "nobody answers this key",
    "AOS605": "the bus cannot be reached",
    "AOS606": "the handler failed",
    "AOS607": "whoever took the question ended before it replied",
    "AOS608": "not allowed on the bus",
    "AOS701": "the journal, or another file of a run, cannot be written",
    "AOS702": "the journal cannot be read",
    "AOS801": "the deploy file is not valid",
    "AOS802": "a service did not start",
    "AOS803": "a second instance on this bus",
    "AOS804": "a service ended unexpectedly",
    "AOS805": "something this machine lacks",
    "AOS806": "an unknown ROS interface",
    "AOS807": "a path that nobody serves",
    "AOS808": "an experiment or a file of mission tests is not valid",
    "AOS809": "a Ray cluster that cannot be used",
    "AOS810": "a run that cannot be taken up",
    "AOS901": "a request that is not valid",
    "AOS902": "nothing is there",
    "AOS903": "the token is needed",
    "AOS904": "a request from elsewhere",
    "AOS905": "the run is over",
}
"""Every code with its meaning; docs/errors.md is made from this table."""


_MOST_NOTES = 20
_LONGEST_TEXT = 4000
"""Messages and hints keep so many characters; a robot may give longer ones."""


class AosError(Exception):
    """A fault with a code, what happened, and what to do.

    `str(error)` reads `AOS601: what. hint`; diagnostics, when there are any, are for the caller to print.
    A traceback of Python 3.11 or later has them as notes.
    """

    code = "AOS606"

    def __init__(
        self,
        message: str,
        *,
        code: str | None = None,
        hint: str = "",
        diagnostics: tuple[Diagnostic, ...] = (),
    ) -> None:
        super().__init__(message := sendable_text(shortened(message, _LONGEST_TEXT)))
        self.code = code or type(self).code
        self.message = message
        self.hint = sendable_text(shortened(hint, _LONGEST_TEXT))
        self.diagnostics = diagnostics
        if sys.version_info >= (3, 11):
            for diagnostic in diagnostics[:_MOST_NOTES]:
                self.add_note(render(diagnostic))

    @property
    def status(self) -> str:
        """The status of an activation that ended with this error, as in `Outcome`."""
        return _STATUS.get(self.code, "failed")

    def __str__(self) -> str:
        text = f"{self.code}: {self.message}"
        end = "" if text.endswith("?") else "."
        return f"{text.rstrip('.')}{end} {self.hint}" if self.hint else text


class DocumentError(AosError):
    code = "AOS104"


class ModelError(AosError):
    code = "AOS201"


class CodeFaultError(ModelError):
    """Code of a document failed while it ran, so that the place of it can be looked for."""

    code = "AOS210"


class EndlessCodeError(CodeFaultError):
    """Code of a document does not come to an end."""

    code = "AOS211"


class EngineDefectError(ModelError):
    """A defect of the engine, which is no fault of the documents."""

    code = "AOS217"


class IntractableError(ModelError):
    """The answer cannot be enumerated: a draw is continuous, or there is too much of it."""

    code = "AOS220"


class PlanningError(AosError):
    code = "AOS302"


class MappingError(AosError):
    code = "AOS401"


class SkillError(AosError):
    code = "AOS502"


class MissionRunsError(SkillError):
    """A mission runs already, so that another one cannot begin."""

    code = "AOS515"


class StudyError(SkillError):
    """A question about a mission that cannot be answered, or not from what was kept of it."""

    code = "AOS530"


class SteeringError(SkillError):
    """Somebody wants something of a mission that cannot be done, or not now; nothing has changed."""

    code = "AOS517"


class BusError(AosError):
    code = "AOS601"


class LateAnswerError(BusError):
    """No reply came in time. Whether the question is being worked on is not known."""

    code = "AOS601"


class NobodyAnswersError(BusError):
    """Nobody took the question: nothing was begun."""

    code = "AOS604"


class LostAnswerError(BusError):
    """Somebody took the question and ended before replying: what was begun is not known."""

    code = "AOS607"


class StorageError(AosError):
    code = "AOS701"


class GatewayError(AosError):
    code = "AOS902"


class DeployError(AosError):
    code = "AOS801"


ANOTHER_MAY_MOVE = "AOS512"
"""A skill is refused for an earlier one, whose failure it is."""

_STATUS = {
    "AOS503": "timed_out",
    "AOS504": "unknown",
    "AOS507": "cancelled",
    **dict.fromkeys(("AOS602", "AOS603", "AOS606"), "unknown"),
    **dict.fromkeys(("AOS502", "AOS505", "AOS506", "AOS511", "AOS512", "AOS514"), "refused"),
}
"""The status of the skill by the code of an error; AOS606 is a defect of the adapter, in the middle of
anything, and a reply that cannot be read (AOS602, AOS603) says nothing of the skill."""

_BY_HUNDRED: dict[str, type[AosError]] = {kind.code[3]: kind for kind in AosError.__subclasses__()}
_SITUATIONS: dict[str, type[AosError]] = {
    kind.code: kind
    for kind in (
        CodeFaultError, EndlessCodeError, EngineDefectError, IntractableError, MissionRunsError, StudyError,
        SteeringError, LateAnswerError, NobodyAnswersError, LostAnswerError,
    )
}  # fmt: skip
_SITUATIONS |= {"AOS214": CodeFaultError, "AOS215": CodeFaultError, "AOS216": EngineDefectError}
_SITUATIONS["AOS518"] = SteeringError


def error_from_code(
    code: str, message: str, *, hint: str = "", diagnostics: tuple[Diagnostic, ...] = ()
) -> AosError:
    """The local exception for a code that came from another process."""
    kind = _SITUATIONS.get(code) or _BY_HUNDRED.get(code[3:4], AosError)
    return kind(message, code=code, hint=hint, diagnostics=diagnostics)
