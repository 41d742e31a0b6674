"""The lowered model as text for people: what `aos inspect --stage model` shows."""

from collections.abc import Iterable, Iterator

from aos_solver.emission.program import (
    EnumVariable,
    Loop,
    Piece,
    Program,
    Section,
    Skill,
    SpecialState,
    Statement,
    Variable,
)


def outline(program: Program) -> str:
    """The program's state, phases and skills, with the document place of all code."""
    return "\n".join(_lines(program)) + "\n"


def _lines(program: Program) -> Iterator[str]:
    copies = "one state without copies" if program.is_one_state else "true copies of the state"
    yield f"project {program.project}: horizon {program.horizon}, discount {program.discount:g}, {copies}"
    for enum in program.enums:
        yield f"enum {enum.name}: {', '.join(enum.values)}"
    for compound in program.compounds:
        yield f"compound {compound.name}: {', '.join(f'{f.name} {f.type}' for f in compound.fields)}"
    yield from _titled("a particle holds", (_variable(variable) for variable in program.particle))
    yield from _titled("constants, which no code changes", (_variable(v) for v in program.constants))
    yield from _titled("initial belief", _section(program.initial_belief))
    yield from _titled("extrinsic changes", _section(program.extrinsic_changes))
    for special in program.special_states:
        yield from _titled(f"special state {special.number}{_flag(special)}", _special_state(special))
    yield from _titled("state heuristic", _section(program.state_heuristic))
    yield from _titled("a state's text", _section(program.print_state))
    for skill in program.skills:
        yield from _skill(skill)
    for monitor in program.monitors:
        title = f"monitor {monitor.name} observes {' | '.join(monitor.responses)}"
        yield from _titled(title, _section(monitor.model))


def _titled(title: str, lines: Iterable[str]) -> Iterator[str]:
    """The title and the lines, indented; nothing if there are no lines."""
    for index, line in enumerate(lines):
        if index == 0:
            yield f"\n{title}"
        yield f"  {line}"


def _variable(variable: Variable) -> str:
    parts = [f"{variable.name}: {variable.type}"]
    if (value := variable.default_value) is not None:
        parts.append(f"= {_one_line(value)}  [{value.snippet.span}]")
    if (code := variable.default_code) is not None:
        parts.append(f"{{ {_one_line(code)} }}  [{code.snippet.span}]")
    if variable.is_parameter_value:
        parts.append("(a value for parameters)")
    if variable.is_mission_parameter:
        parts.append("(a mission parameter)")
    return " ".join(parts)


def _special_state(special: SpecialState) -> Iterator[str]:
    if special.condition is None:
        yield from _section(special.section)
        return
    ends = ", ends the mission" * special.is_terminal + " as a failure" * special.is_failure
    yield f"if {_one_line(special.condition)}: {special.reward:+g}{ends}  [{special.condition.snippet.span}]"


def _flag(special: SpecialState) -> str:
    return f" (can be used up: flag {special.bit:#x})" if special.bit else ""


def _skill(skill: Skill) -> Iterator[str]:
    parameters = ", ".join(f"{parameter.name}: {parameter.type}" for parameter in skill.parameters)
    observations = " | ".join(skill.responses) or ("a text" if skill.has_text_response else "nothing")
    yield f"\nskill {skill.name}({parameters}) observes {observations}"
    for parameter in skill.parameters:
        if parameter.values is not None:
            yield f"  {parameter.name} is one of {', '.join(parameter.values.variables)}"
    if skill.violation_penalty:
        yield f"  a violated precondition costs {skill.violation_penalty:g}"
    if skill.reported:
        yield f"  a real observation tells the values of {', '.join(skill.reported)}"
    for title, section in (
        ("possible parameters", skill.possible_parameters),
        ("precondition", skill.precondition),
        ("execution time", skill.execution_time),
        ("dynamic model", skill.dynamic_model),
        ("rollout policy", skill.rollout_policy),
        ("state given the observation", skill.given_observation),
    ):
        if section is not None:
            yield f"  {title}"
            yield from (f"    {line}" for line in _section(section))


def _section(section: Section | None) -> Iterator[str]:
    for statement in section.statements if section is not None else ():
        yield from _statement(statement)


def _statement(statement: Statement) -> Iterator[str]:
    if isinstance(statement, Piece):
        yield f"[{statement.snippet.span}]"
        yield from (f"| {line}" for line in statement.text.split("\n"))
    elif isinstance(statement, Loop):
        yield from _loop(statement)
    elif isinstance(statement, EnumVariable):
        yield f"{statement.name}: a number over {', '.join(statement.values)}"
    else:
        yield f"{statement.name}: {statement.type}"


def _loop(loop: Loop) -> Iterator[str]:
    item = loop.item if loop.is_reference else f"copy {loop.item}"
    condition = f" where {_one_line(loop.condition)}" if loop.condition is not None else ""
    yield f"for every {loop.type} {item} of {loop.copy}{condition}"
    if loop.body is not None:
        yield from (f"  {line}" for line in _statement(loop.body))
    if loop.inner is not None:
        yield from (f"  {line}" for line in _loop(loop.inner))


def _one_line(piece: Piece) -> str:
    return " ".join(piece.text.split())
