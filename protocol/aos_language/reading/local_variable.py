"""The kind of local variable that a set of attributes makes, the same for every dialect."""

import msgspec

from aos_language.findings import Findings
from aos_language.reading.document import check_name
from aos_language.reading.source import Text
from aos_protocol.diagnostics import Span
from aos_protocol.documents import Import, LocalSource, LocalVariable, Snippet

JSON_SOURCES = ("FromGlobalVariable", "FromROSServiceResponse", "RosTopicPath")
_SDL_SOURCES = ("action_parameter:", "from_ros_service_response:", "topic:")


class LocalVariableParts(msgspec.Struct, frozen=True, kw_only=True):
    """The attributes that a document gives a local variable, as they were found."""

    name: Text | None
    span: Span
    type: str = ""
    parameter_path: Text | None = None
    is_from_service: bool = False
    topic: Text | None = None
    message_type: Text | None = None
    initial_value: Snippet | None = None
    code: Snippet | None = None
    imports: tuple[Import, ...] = ()
    is_heavy: bool = False
    service_span: Span | None = None

    @property
    def sources(self) -> list[LocalSource]:
        """The sources that are given; a variable has one."""
        given = {
            LocalSource.PARAMETER: self.parameter_path is not None,
            LocalSource.SERVICE_RESPONSE: self.is_from_service,
            LocalSource.TOPIC: self.topic is not None,
        }
        return [source for source, is_given in given.items() if is_given]


def build_local_variable(parts: LocalVariableParts, findings: Findings) -> LocalVariable | None:
    """The variable; None, with a finding, where name, source or code are missing or contradict."""
    if parts.name is None:
        findings.error("AOS105", "a local variable lacks its name", parts.span)
        return None
    check_name(parts.name, "a local variable", findings)
    source = _source(parts, findings)
    if source is None:
        return None
    if source is not LocalSource.PARAMETER and parts.code is None:
        message = f"the local variable {parts.name.text} has no code that gives its value"
        findings.error("AOS105", message, parts.name.span)
        return None
    given = parts.parameter_path or parts.topic
    return LocalVariable(
        name=parts.name.text,
        source=source,
        span=parts.name.span,
        type=parts.type,
        parameter_path=parts.parameter_path.text if parts.parameter_path else "",
        topic=parts.topic.text if parts.topic else "",
        message_type=parts.message_type.text if parts.message_type else "",
        initial_value=parts.initial_value,
        code=parts.code,
        imports=parts.imports,
        is_heavy=parts.is_heavy,
        source_span=given.span if given is not None else None,
    )


def _source(parts: LocalVariableParts, findings: Findings) -> LocalSource | None:
    sources = parts.sources
    span = parts.name.span if parts.name else parts.span
    if len(sources) == 1:
        return sources[0]
    if not sources:
        is_json = span.file.endswith(".json")
        parameter, result, topic = JSON_SOURCES if is_json else _SDL_SOURCES
        hint = (
            f"Take it from a skill parameter (`{parameter}`), the call's result (`{result}`) "
            f"or a topic (`{topic}`)"
        )
        findings.error("AOS105", "this local variable has no source", span, hint)
    else:
        given_at = [text.span for text in (parts.parameter_path, parts.topic) if text is not None]
        given_at += [parts.service_span] if parts.service_span is not None else []
        hint = "Keep one of them, or begin another local variable above this one"
        findings.error("AOS106", "this local variable has more than one source", max(given_at), hint)
    return None
