"""A project as text for people: the typed documents, each part with the place it comes from."""

from collections.abc import Iterator

from aos_protocol import documents
from aos_protocol.diagnostics import Span

_PLACE_COLUMN = 78
_PLACE = "\0"
"""The mark between a line's text and its place, until all lines are there and can be aligned."""


def outline(project: documents.Project) -> str:
    """The whole project, environment first, then each skill with its mapping."""
    environment = project.environment
    title = f"project {project.name}: horizon {environment.horizon}, discount {environment.discount:g}"
    lines = [_placed(title, environment.span)]
    lines += _environment(environment)
    if project.low_level is not None:
        lines += _low_level(project.low_level)
    for skill in project.skills:
        lines += ["", *_skill(skill)]
    for mapping in project.monitors:
        place = _placed(f"monitor {mapping.monitor}", mapping.activation.span)
        lines += ["", place, *_indented(_responses(mapping))]
    return "".join(f"{_aligned(line)}\n" for line in lines)


def _environment(environment: documents.Environment) -> Iterator[str]:
    if environment.is_one_state_model:
        yield "one state model: state, state_ and state__ are the same"
    if environment.shared_code is not None:
        yield _placed("shared code", environment.shared_code.span)
        yield from _code(environment.shared_code)
    if environment.shared_mapping_code is not None:
        yield _placed("shared code of the mappings", environment.shared_mapping_code.span)
        yield from _code(environment.shared_mapping_code)
    for enum in environment.enums:
        yield _placed(f"enum {enum.name}: {', '.join(enum.values)}", enum.span)
    for compound in environment.compounds:
        yield _placed(f"compound {compound.name}", compound.span)
        for field in compound.fields:
            default = f" = {field.default.code}" if field.default else ""
            low_level = f" of {field.low_level_type}" if field.low_level_type else ""
            yield _placed(f"  {field.type} {field.name}{default}{low_level}", field.span)
    for variable in environment.variables:
        yield from _variable(variable)
    yield from _block("initial belief", environment.initial_belief)
    for special in environment.special_states:
        yield from _special_state(special)
    yield from _block("extrinsic changes", environment.extrinsic_changes)
    yield from _block("state heuristic", environment.state_heuristic)
    yield from _block("print function", environment.print_state)
    for monitor in environment.monitors:
        yield _placed(f"monitor {monitor.name}, a response from the state after each step", monitor.span)
        for assignment in monitor.code:
            yield from _code(assignment.code)


def _variable(variable: documents.StateVariable) -> Iterator[str]:
    kind = "action parameter value" if variable.is_parameter_value else "variable"
    kind = "mission parameter" if variable.is_mission_parameter else kind
    keys = f" by ({', '.join(variable.key_types)})" if variable.key_types else ""
    array = f"[{variable.index_enum}]" if variable.is_array else ""
    default = f" = {variable.default_value.code}" if variable.default_value else ""
    yield _placed(f"{kind} {variable.type}{array} {variable.name}{keys}{default}", variable.span)
    yield from _code(variable.default_code)


def _special_state(special: documents.SpecialState) -> Iterator[str]:
    flags = ", goal" * special.is_goal + ", once" * special.is_one_time
    flags += "" if special.is_failure is None else ", failure" if special.is_failure else ", no failure"
    if special.condition is None:
        yield from _block("special state", special.code)
        return
    yield _placed(f"special state: reward {special.reward:g}{flags}, when", special.span)
    yield from _code(special.condition)


def _low_level(document: documents.LowLevelDocument) -> Iterator[str]:
    for kind in document.types:
        fields = ", ".join(f"{field.type} {field.name}" for field in kind.fields)
        yield _placed(f"low-level type {kind.name}: {fields}", kind.span)
    for constant in document.constants:
        yield _placed(f"low-level constant {constant.type} {constant.name}", constant.span)
        yield from _code(constant.code)


def _skill(skill: documents.Skill) -> Iterator[str]:
    model = skill.model
    parameters = ", ".join(f"{parameter.type} {parameter.name}" for parameter in model.parameters)
    yield _placed(f"skill {model.name}({parameters})", model.span)
    yield from _indented(_block("parameter values", model.possible_parameters))
    precondition = f"precondition, {model.violation_penalty:g} when it does not hold"
    yield from _indented(_block(precondition, model.precondition))
    yield from _indented(_block("rollout policy", model.rollout_policy))
    yield from _indented(_block("execution time", model.execution_time))
    yield from _indented(_block("dynamic model", model.dynamic_model))
    yield from _indented(_block("state given the observation", model.state_given_observation))
    yield from _indented(_mapping(skill.mapping))


def _mapping(mapping: documents.AbstractionMapping) -> Iterator[str]:
    activation = mapping.activation
    fields = ", ".join(f"{field.name}={field.value.code}" for field in activation.fields)
    service = f" of type {activation.service_type}" if activation.service_type else ""
    limit = f", at most {activation.max_duration_s:g} s" if activation.max_duration_s else ""
    call = f"activation: {activation.kind} {activation.path}({fields}){service}{limit}"
    yield _placed(call, activation.span)
    if mapping.is_derived:
        yield "derived: no abstraction mapping is written"
    yield from _imports(activation.imports)
    yield from _responses(mapping)


def _responses(mapping: documents.AbstractionMapping) -> Iterator[str]:
    for rule in mapping.rules:
        condition = rule.condition.code if rule.condition else "True"
        yield _placed(f"response {rule.response} when {condition}", rule.span)
        for assignment in rule.assignments:
            yield _placed(f"  {assignment.path} becomes {assignment.value.code}", assignment.span)
    if mapping.response_variable:
        yield f"response is the text of {mapping.response_variable}"
    if mapping.stop_when is not None:
        yield _placed("stopped when", mapping.stop_when.span)
        yield from _code(mapping.stop_when)
    for variable in mapping.local_variables:
        yield from _local_variable(variable)


def _local_variable(variable: documents.LocalVariable) -> Iterator[str]:
    origin = {
        documents.LocalSource.PARAMETER: f"parameter {variable.parameter_path}",
        documents.LocalSource.SERVICE_RESPONSE: "the service's response",
        documents.LocalSource.TOPIC: f"topic {variable.topic} ({variable.message_type or 'any message'})",
    }[variable.source]
    kind = f"{variable.type} " if variable.type else ""
    initial = f", at first {variable.initial_value.code}" if variable.initial_value else ""
    yield _placed(f"local variable {kind}{variable.name} from {origin}{initial}", variable.span)
    yield from _imports(variable.imports)
    yield from _code(variable.code)


def _imports(imports: tuple[documents.Import, ...]) -> Iterator[str]:
    for item in imports:
        names = ", ".join(item.names)
        yield f"  from {item.module} import {names}" if item.module else f"  import {names}"


def _block(title: str, block: tuple[documents.Assignment, ...]) -> Iterator[str]:
    for assignment in block:
        yield _placed(title, assignment.span)
        if assignment.temporary is not None:
            temporary = assignment.temporary
            values = f" {temporary.enum_name}: {', '.join(temporary.enum_values)}"
            yield f"  temporary {temporary.type} {temporary.name}{values if temporary.enum_name else ''}"
        for copy, loops in (("previous", assignment.over_previous), ("next", assignment.over_next)):
            for loop in loops:
                yield f"  for each {loop.type} {loop.item} of the {copy} state, when"
                yield from _indented(_code(loop.condition))
                yield from _indented(_code(loop.body))
        yield from _code(assignment.code)


def _code(snippet: documents.Snippet | None) -> Iterator[str]:
    if snippet is not None:
        for line in snippet.code.split("\n"):
            yield f"  | {line}".rstrip()


def _indented(lines: Iterator[str]) -> Iterator[str]:
    return (f"  {line}" for line in lines)


def _placed(text: str, span: Span) -> str:
    return f"{text}{_PLACE}{span}"


def _aligned(line: str) -> str:
    text, _, place = line.partition(_PLACE)
    return f"{text:<{_PLACE_COLUMN}}  {place}" if place else text
