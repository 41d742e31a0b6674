"""The functions and tables of a generated mapping module, as marked lines for the template.

Pure: typed documents in, lines and diagnostics out. What each part means is said in docs/middleware.md.
"""

from collections.abc import Iterable

import msgspec

from aos_middleware.emission.generated_lines import literal, word
from aos_middleware.emission.python_code import LineOrigin, PythonCode
from aos_middleware.emission.read_snippets import ReadSnippets, function_name
from aos_protocol.documents import AbstractionMapping, LocalSource, LocalVariable

_OF_SKILL = ("__skill_status", "__skill_error")
"""The names by which rules read how a skill has failed."""

_HAS_ENDED = "__skill_has_ended"
"""True where a skill has not failed: the rules without the names above hold only then."""


class Function(msgspec.Struct, frozen=True):
    """A generated function: its name, its arguments as text, its docstring and its body."""

    name: str
    reads: str
    summary: str
    lines: tuple[str, ...]


class Table(msgspec.Struct, frozen=True):
    """A module-level dict."""

    name: str
    lines: tuple[str, ...]


class Sections:
    """Builds the functions and tables of one mapping's module.

    After `observe`, `handles_failures` says whether a rule looks at how the skill has ended.
    """

    def __init__(self, mapping: AbstractionMapping, snippets: ReadSnippets) -> None:
        self.handles_failures = False
        self._mapping = mapping
        self._snippets = snippets

    # --- activation ---

    def start_values(self) -> list[str]:
        """The entries of the dict that `local_variables` returns."""
        lines: list[str] = []
        for variable in self._snippets.variables.values():
            before = f"{literal(variable.name)}: "
            if variable.initial_value is not None:
                if code := self._snippets.expression(variable.initial_value):
                    lines += self._snippets.marks.expression(before, code, ",", 2)
                continue
            value = "None"
            if variable.source is LocalSource.PARAMETER:
                keys = "".join(f"[{literal(key)}]" for key in variable.parameter_path.split("."))
                value = f"parameters{keys}"
            origin = LineOrigin.of_span(variable.span)
            lines.append(self._snippets.marks.line(f"{' ' * 8}{before}{value},", origin))
        return lines

    def request(self) -> Function:
        """The function that makes the fields of the call; its lines are a dict's entries."""
        codes = [
            (field, code)
            for field in self._mapping.activation.fields
            if (code := self._snippets.expression(field.value))
        ]
        lines: list[str] = []
        for field, code in codes:
            lines += self._snippets.marks.expression(f"{literal(field.name)}: ", code, ",", 2)
        reads = ", ".join(self._snippets.read_by(code for _, code in codes))
        return Function("request", reads, word(self._mapping.activation.path), tuple(lines))

    # --- local variables ---

    def functions(self) -> list[Function]:
        """The functions that are called during an activation, the condition that stops the skill last."""
        stop_when = self._stop_when()
        return [*self._variable_functions(), *([stop_when] if stop_when is not None else [])]

    def _variable_functions(self) -> list[Function]:
        functions = []
        for variable in self._snippets.variables.values():
            if variable.source is LocalSource.PARAMETER:
                continue
            if variable.code is None:
                self._snippets.mistake(
                    "AOS105", f"the local variable {variable.name} has no code", variable.span
                )
            elif code := self._snippets.body(variable.code):
                functions.append(self._variable_function(variable, code))
        return functions

    def _variable_function(self, variable: LocalVariable, code: PythonCode) -> Function:
        is_topic = variable.source is LocalSource.TOPIC
        lines = self._snippets.marks.body(code, 1)
        # Falling off the end keeps the variable's value, or gives it the one assigned in the code.
        needs_end = code.returns != "always"
        if needs_end:
            origin = LineOrigin.of_span(variable.span)
            lines.append(self._snippets.marks.line(f"    return {variable.name}", origin))
        may_give = is_topic or variable.name in code.assigns or code.returns == "sometimes"
        own = {variable.name} if may_give and needs_end else set()
        if is_topic:
            source = f"a message ({word(variable.message_type)}) on {word(variable.topic)}"
        else:
            source = f"the result of {word(self._mapping.activation.path)}"
        return Function(
            function_name(variable),
            ", ".join(["__input", *self._snippets.read_by([code], own)]),
            f"The value of {variable.name} after {source}.",
            tuple(lines),
        )

    def tables(self, low_level_names: Iterable[str]) -> list[Table]:
        """Returns the tables of which function belongs to which topic and variable, and of the low-level
        constants."""
        topics: dict[str, list[LocalVariable]] = {}
        response: list[str] = []
        for variable in self._snippets.variables.values():
            if variable.source is LocalSource.TOPIC:
                topics.setdefault(variable.topic, []).append(variable)
            elif variable.source is LocalSource.SERVICE_RESPONSE:
                response.append(f"    {literal(variable.name)}: {function_name(variable)},")
        by_topic: list[str] = []
        for topic, variables in topics.items():
            by_topic.append(f"    {literal(topic)}: {{")
            by_topic += [
                f"        {literal(variable.name)}: {function_name(variable)}," for variable in variables
            ]
            by_topic.append("    },")
        constants = [f"    {literal(name)}: {name}," for name in low_level_names]
        tables = (("TOPICS", by_topic), ("RESPONSE", response), ("CONSTANTS", constants))
        return [Table(name, tuple(lines)) for name, lines in tables if lines]

    # --- observation ---

    def observe(self) -> Function:
        """The function from local variables to the response; None where there is none."""
        mapping = self._mapping
        if mapping.response_variable:
            return self._observe_text(mapping.response_variable)
        if not mapping.rules:
            summary = "The response: the skill's only one."
            return Function("observe", "", summary, ('    return "DefaultObservation"',))
        conditions = [
            None if rule.condition is None else self._snippets.expression(rule.condition)
            for rule in mapping.rules
        ]
        read = frozenset[str]().union(*(code.reads for code in conditions if code is not None))
        of_skill = [name for name in _OF_SKILL if name in read]
        lines: list[str] = []
        codes: list[PythonCode] = []
        has_assignments = False
        for rule, code in zip(mapping.rules, conditions, strict=True):
            assigned = [
                (assignment, value)
                for assignment in rule.assignments
                if (value := self._snippets.expression(assignment.value))
            ]
            holds_always = code is None or code.is_true
            is_for_ended = bool(of_skill) and (code is None or code.reads.isdisjoint(_OF_SKILL))
            is_last = holds_always and not is_for_ended
            if code is not None and not holds_always:
                codes.append(code)
                before, after = (f"if {_HAS_ENDED} and (", "):") if is_for_ended else ("if ", ":")
                lines += self._snippets.marks.expression(before, code, after, 1)
            elif is_for_ended:
                lines.append(f"    if {_HAS_ENDED}:")
            depth = 1 if is_last else 2
            for assignment, value in assigned:
                codes.append(value)
                has_assignments = True
                lines += self._snippets.marks.expression(
                    f"__assign({literal(assignment.path)}, ", value, ")", depth
                )
            lines.append(f"{' ' * 4 * depth}return {literal(rule.response)}")
            if holds_always:
                break
        if not is_last:
            lines.append("    return None")
        summary = "The response: that of the first rule that holds."
        reads = self._snippets.read_by(codes)
        self.handles_failures = bool(of_skill)
        reads += [*of_skill, *([_HAS_ENDED] if any(_HAS_ENDED in line for line in lines) else [])]
        return Function(
            "observe", ", ".join(["__assign", *reads] if has_assignments else reads), summary, tuple(lines)
        )

    def _observe_text(self, name: str) -> Function:
        span = self._mapping.response_variable_span or self._mapping.span
        if name not in self._snippets.variables:
            self._snippets.mistake("AOS110", f"the response is the text of {name}, no local variable", span)
        summary = f"The response: the text of {word(name)}."
        origin = LineOrigin.of_span(span)
        line = self._snippets.marks.line(f"    return None if {name} is None else str({name})", origin)
        return Function("observe", name, summary, (line,))

    def _stop_when(self) -> Function | None:
        """The function that says whether a skill that runs is to be stopped; None where nothing stops it."""
        if self._mapping.stop_when is None:
            return None
        code = self._snippets.expression(self._mapping.stop_when)
        if code is None:
            return None
        lines = self._snippets.marks.expression("return ", code, "", 1)
        summary = "The skill is stopped as soon as this is True; it is asked after each message."
        if self._mapping.monitor:
            summary = "The skill that runs is stopped when this becomes True; it is asked after each message."
        return Function("stop_when", ", ".join(self._snippets.read_by([code])), summary, tuple(lines))
