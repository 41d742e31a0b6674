"""A document as SDL text."""

import re
from collections.abc import Iterable, Iterator

from aos_protocol import documents

_LOOKS_LIKE_A_SCALE = re.compile(r".*\S\s+(ml_ignore|[\d.]+)")


def sdl_text(content: documents.Content, version: str = "") -> str:
    """The text of an `.ef`, `.sd`, `.am` or `.lf` file. Names of skills are file names, and not in it."""
    lines = [f"project: {content.project}"]
    if version:
        lines.append(f"version: {version}")
    match content:
        case documents.Environment():
            lines += _environment(content)
        case documents.SkillModel():
            lines += _skill(content)
        case documents.AbstractionMapping():
            lines += _mapping(content)
        case documents.LowLevelDocument():
            lines += _low_level(content)
    return "".join(f"{line}\n" for line in lines)


# --- environment and low-level file ---


def _environment(environment: documents.Environment) -> Iterator[str]:
    yield f"horizon: {environment.horizon}"
    yield f"discount: {environment.discount!r}"
    if environment.is_one_state_model:
        yield "one_state_model: true"
    if environment.shared_code is not None:
        yield from ("", *_code("shared_code", environment.shared_code))
    if environment.shared_mapping_code is not None:
        yield from ("", *_code("shared_mapping_code", environment.shared_mapping_code))
    for enum in environment.enums:
        yield from ("", f"define_type: {enum.name}", f"enum_members: {', '.join(enum.values)}")
    for compound in environment.compounds:
        yield from ("", f"define_type: {compound.name}", *map(_field, compound.fields))
    for variable in environment.variables:
        yield from ("", *_variable(variable))
    yield from _block("initial_belief", environment.initial_belief)
    for special in environment.special_states:
        yield from _special_state(special)
    yield from _block("extrinsic_code", environment.extrinsic_changes)
    yield from _block("heuristic_code", environment.state_heuristic)
    yield from _block("print_code", environment.print_state)
    for monitor in environment.monitors:
        yield from ("", f"monitor: {monitor.name}", *_code("code", monitor.code[0].code))


def _field(field: documents.Field) -> str:
    default = field.default.code if field.default is not None else ""
    if _LOOKS_LIKE_A_SCALE.fullmatch(default):
        default += " 1"  # Of two numbers at the end the last is taken for the learning planner's.
    low_level_type = f"of {field.low_level_type}" if field.low_level_type else ""
    return " ".join(part for part in ("variable:", field.type, field.name, low_level_type, default) if part)


def _variable(variable: documents.StateVariable) -> Iterator[str]:
    word = "action_parameter:" if variable.is_parameter_value else "state_variable:"
    word = "mission_parameter:" if variable.is_mission_parameter else word
    array = f"[{variable.index_enum}]" if variable.is_array else ""
    low_level_type = f"of {variable.low_level_type}" if variable.low_level_type else ""
    yield " ".join(part for part in (word, variable.type, variable.name, array, low_level_type) if part)
    if variable.key_types:
        yield f"key_types: {', '.join(variable.key_types)}"
    yield from _expression("default_value", variable.default_value)
    yield from _code("code", variable.default_code)


def _special_state(special: documents.SpecialState) -> Iterator[str]:
    if special.condition is None:
        yield from _block("reward_code", special.code)
        return
    yield from ("", "special_state:", *_expression("state_condition", special.condition))
    yield f"reward: {special.reward!r}"
    if special.is_goal:
        yield "is_goal_state: true"
    if special.is_failure is not None:
        yield f"is_failure_state: {str(special.is_failure).lower()}"
    if special.is_one_time:
        yield "is_one_time_reward: true"


def _low_level(document: documents.LowLevelDocument) -> Iterator[str]:
    for kind in document.types:
        yield from ("", f"define_type: {kind.name}")
        yield from (f"variable: {field.type} {field.name}" for field in kind.fields)
    for constant in document.constants:
        yield from ("", f"constant: {constant.type} {constant.name}", *_code("code", constant.code))


# --- skill document ---


def _skill(model: documents.SkillModel) -> Iterator[str]:
    yield from (f"parameter: {parameter.type} {parameter.name}" for parameter in model.parameters)
    yield from _block("available_parameters_code", model.possible_parameters)
    yield from _block("precondition", model.precondition)
    if model.violation_penalty:
        yield f"violate_penalty: {model.violation_penalty!r}"
    yield from _block("rollout_policy", model.rollout_policy)
    yield from _block("execution_time", model.execution_time)
    yield from _block("dynamic_model", model.dynamic_model) if model.dynamic_model else ("", "dynamic_model:")
    yield from _block("state_given_observation", model.state_given_observation)


# --- abstraction mapping ---


def _mapping(mapping: documents.AbstractionMapping) -> Iterator[str]:
    if mapping.rules or mapping.response_variable:
        yield ""
    for rule in mapping.rules:
        yield f"response: {rule.response}"
        yield from (
            _expression("response_rule", rule.condition) if rule.condition else ("response_rule: True",)
        )
        for assignment in rule.assignments:
            yield f"assign_variable: {assignment.path}"
            yield from _expression("value", assignment.value)
    if mapping.response_variable:
        yield f"response_local_variable: {mapping.response_variable}"
    if mapping.stop_when is not None:
        yield from ("", *_expression("stop_when", mapping.stop_when))
    if mapping.monitor:
        yield from ("", f"monitor: {mapping.monitor}")
    else:
        yield from _activation(mapping.activation)
    for variable in mapping.local_variables:
        yield from ("", *_local_variable(variable))


def _activation(activation: documents.Activation) -> Iterator[str]:
    yield from ("", f"module_activation: {activation.kind}")
    yield from map(_import, activation.imports)
    yield f"path: {activation.path}"
    if activation.service_type:
        yield f"srv: {activation.service_type}"
    if activation.max_duration_s is not None:
        yield f"max_duration: {activation.max_duration_s!r}"
    for field in activation.fields:
        yield from (f"parameter: {field.name}", *_code("code", field.value))


def _local_variable(variable: documents.LocalVariable) -> Iterator[str]:
    yield f"local_variable: {variable.name}"
    match variable.source:
        case documents.LocalSource.PARAMETER:
            yield f"action_parameter: {variable.parameter_path}"
        case documents.LocalSource.SERVICE_RESPONSE:
            yield "from_ros_service_response: true"
        case documents.LocalSource.TOPIC:
            yield f"topic: {variable.topic}"
    if variable.message_type:
        yield f"message_type: {variable.message_type}"
    if variable.type:
        yield f"type: {variable.type}"
    yield from _expression("initial_value", variable.initial_value)
    yield from map(_import, variable.imports)
    if variable.is_heavy:
        yield "is_heavy_variable: true"
    yield from _code("code", variable.code)


def _import(item: documents.Import) -> str:
    origin = f"from: {item.module} " if item.module else ""
    return f"imports: {origin}import: {', '.join(item.names)}"


# --- code ---


def _block(word: str, block: tuple[documents.Assignment, ...]) -> Iterator[str]:
    """The section of a block: its body where that is all there is to say, or else its assignments."""
    if not block:
        return
    yield from ("", f"{word}:")
    if len(block) == 1 and block[0] == documents.Assignment(block[0].span, code=block[0].code):
        yield from _lines(block[0].code)
        return
    for assignment in block:
        yield f"assignment: {assignment.name}".rstrip()
        if assignment.temporary is not None:
            yield f"temporary_variable: {_temporary(assignment.temporary)}"
        yield from _loops("loop_previous", assignment.over_previous)
        yield from _loops("loop_next", assignment.over_next)
        yield from _code("code", assignment.code)


def _temporary(temporary: documents.TemporaryVariable) -> str:
    if not temporary.enum_name:
        return f"{temporary.type} {temporary.name}"
    return f"enum {temporary.enum_name} {{ {', '.join(temporary.enum_values)} }} {temporary.name}"


def _loops(word: str, loops: Iterable[documents.Iteration]) -> Iterator[str]:
    for loop in loops:
        yield f"{word}: {loop.type} {loop.item}"
        yield from _expression("loop_condition", loop.condition)
        yield from _code("loop_body", loop.body)


def _expression(word: str, snippet: documents.Snippet | None) -> Iterator[str]:
    """Yields the expression on the line of its word where it fits there, else below it."""
    if snippet is not None:
        is_short = "\n" not in snippet.code
        yield from (f"{word}: {snippet.code}",) if is_short else (f"{word}:", *_lines(snippet))


def _code(word: str, snippet: documents.Snippet | None) -> Iterator[str]:
    if snippet is not None:
        yield from (f"{word}:", *_lines(snippet))


def _lines(snippet: documents.Snippet | None) -> list[str]:
    return snippet.code.split("\n") if snippet is not None else []
