"""The functions and tables of a generated mapping module, as marked lines for the template.

Pure: typed documents in, lines and diagnostics out. What each part means is said in docs/middleware.md.
"""

from collections.abc import Iterable

import msgspec

from aos_language.local_types import OF_SKILL
from aos_middleware.emission.generated_lines import ReadSnippets, function_name, literal, word
from aos_middleware.emission.python_code import LineOrigin, PythonCode
from aos_protocol.documents import (
    DEFAULT_RESPONSE,
    AbstractionMapping,
    LocalSource,
    LocalVariable,
    ResponseRule,
)

_HAS_ENDED, _HAS_FAILED = (f"__skill_status {test} ('succeeded', 'stopped')" for test in ("in", "not in"))
"""Tests of whether the skill has failed, for rules without these names beside rules with them."""


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
        """A function for each local variable whose value comes from outside during the activation."""
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
            return Function("observe", "", summary, (f'    return "{DEFAULT_RESPONSE}"',))
        conditions = [
            None if rule.condition is None else self._snippets.expression(rule.condition)
            for rule in mapping.rules
        ]
        of_end = [
            index for index, code in enumerate(conditions) if code and not code.reads.isdisjoint(OF_SKILL)
        ]
        self.handles_failures = bool(of_end)
        last_of_end = max(of_end, default=len(conditions))
        lines: list[str] = []
        codes: list[PythonCode] = []
        for index, (rule, code) in enumerate(zip(mapping.rules, conditions, strict=True)):
            if index == last_of_end + 1:
                lines += [f"    if {_HAS_FAILED}:", "        return None"]
            only_ended = index < last_of_end and index not in of_end and bool(of_end)
            test = self._test(code, only_ended=only_ended)
            lines += test
            lines += self._given(rule, codes, depth=2 if test else 1)
            if code is not None and test:
                codes.append(code)
            if not test:
                break
        else:
            lines.append("    return None")
        has_assignments = any("__assign(" in line for line in lines)
        reads = ["__assign"] if has_assignments else []
        reads += self._snippets.read_by(codes)
        reads += [name for name in OF_SKILL if any(name in line for line in lines)]
        summary = "The response: that of the first rule that holds."
        return Function("observe", ", ".join(reads), summary, tuple(lines))

    def _test(self, code: PythonCode | None, *, only_ended: bool) -> list[str]:
        """The line that tests a rule, `only_ended` whether the skill has not failed, too; none where the rule
        always holds."""
        if code is None or code.is_true:
            return [f"    if {_HAS_ENDED}:"] if only_ended else []
        before, after = (f"if {_HAS_ENDED} and (", "):") if only_ended else ("if ", ":")
        return self._snippets.marks.expression(before, code, after, 1)

    def _given(self, rule: ResponseRule, codes: list[PythonCode], *, depth: int) -> list[str]:
        """Lines that make a rule's assignments and return its response; adds what they read to `codes`."""
        lines: list[str] = []
        for assignment in rule.assignments:
            if value := self._snippets.expression(assignment.value):
                codes.append(value)
                start = f"__assign({literal(assignment.path)}, "
                lines += self._snippets.marks.expression(start, value, ")", depth)
        return [*lines, f"{' ' * 4 * depth}return {literal(rule.response)}"]

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
