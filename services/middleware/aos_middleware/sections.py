"""The parts of a generated mapping module, as marked lines for the template.

Pure: typed documents in, lines and diagnostics out. What each part means is said in docs/middleware.md.
"""

from __future__ import annotations

import ast
import builtins
import keyword
from collections.abc import Iterable, Iterator

import msgspec

from aos_language.local_types import RESERVED_LOCAL_NAMES
from aos_middleware.generated_lines import MarkedLines, literal, word
from aos_middleware.python_code import LineOrigin, PythonCode, read_body, read_expression
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.documents import (
    AbstractionMapping,
    Import,
    LocalSource,
    LocalVariable,
    LowLevelDocument,
    Snippet,
)

__all__ = ["Function", "ImportPart", "Sections", "Table"]

_PRIMITIVES = frozenset({"bool", "int", "float", "double", "string", "str"})
_OF_SKILL = ("__skill_status", "__skill_error")
"""The names by which rules read how a skill has failed."""


class Function(msgspec.Struct, frozen=True):
    """A generated function: its name, its arguments as text, its docstring and its body."""

    name: str
    reads: str
    summary: str
    lines: tuple[str, ...]


class ImportPart(msgspec.Struct, frozen=True):
    """An import and what stands in for it: statements of the `except` branch."""

    load: str
    otherwise: tuple[str, ...]


class Table(msgspec.Struct, frozen=True):
    """A module-level dict."""

    name: str
    lines: tuple[str, ...]


class Sections:
    """Builds the parts of one mapping's module, collecting the document's mistakes in `diagnostics`.

    After `observe`, `handles_failures` says whether a rule looks at how the skill has ended.
    """

    def __init__(
        self,
        mapping: AbstractionMapping,
        low_level: LowLevelDocument | None,
        shared: Snippet | None = None,
    ) -> None:
        self.diagnostics: list[Diagnostic] = []
        self.marks = MarkedLines()
        self.handles_failures = False
        self._mapping = mapping
        self._low_level = low_level
        self._shared = shared
        self._variables = {variable.name: variable for variable in mapping.local_variables}
        self._codes: list[PythonCode] = []
        self._check_names()

    # --- activation ----------------------------------------------------------------------------------

    def start_values(self) -> list[str]:
        """The entries of the dict that `local_variables` returns."""
        lines: list[str] = []
        for variable in self._variables.values():
            before = f"{literal(variable.name)}: "
            if variable.initial_value is not None:
                if code := self._expression(variable.initial_value):
                    lines += self.marks.expression(before, code, ",", 2)
                continue
            value = "None"
            if variable.source is LocalSource.PARAMETER:
                keys = "".join(f"[{literal(key)}]" for key in variable.parameter_path.split("."))
                value = f"parameters{keys}"
            origin = LineOrigin.of_span(variable.span)
            lines.append(self.marks.line(f"{' ' * 8}{before}{value},", origin))
        return lines

    def request(self) -> Function:
        """The function that makes the fields of the call; its lines are a dict's entries."""
        codes = [
            (field, code)
            for field in self._mapping.activation.fields
            if (code := self._expression(field.value))
        ]
        lines: list[str] = []
        for field, code in codes:
            lines += self.marks.expression(f"{literal(field.name)}: ", code, ",", 2)
        reads = self._reads(code for _, code in codes)
        return Function("request", reads, word(self._mapping.activation.path), tuple(lines))

    # --- local variables -----------------------------------------------------------------------------

    def functions(self) -> list[Function]:
        """The functions that are called during an activation, the condition that stops the skill last."""
        stop_when = self._stop_when()
        return [*self._variable_functions(), *([stop_when] if stop_when is not None else [])]

    def _variable_functions(self) -> list[Function]:
        """A function for each local variable whose value comes from outside during the activation."""
        functions = []
        for variable in self._variables.values():
            if variable.source is LocalSource.PARAMETER:
                continue
            if variable.code is None:
                self._mistake("AOS105", f"the local variable {variable.name} has no code", variable.span)
            elif code := self._kept(read_body(variable.code)):
                functions.append(self._variable_function(variable, code))
        return functions

    def _variable_function(self, variable: LocalVariable, code: PythonCode) -> Function:
        is_topic = variable.source is LocalSource.TOPIC
        lines = self.marks.body(code, 1)
        # Falling off the end keeps the variable's value, or gives it the one assigned in the code.
        needs_end = code.returns != "always"
        if needs_end:
            origin = LineOrigin.of_span(variable.span)
            lines.append(self.marks.line(f"    return {variable.name}", origin))
        own = {variable.name} if is_topic and needs_end else set()
        if is_topic:
            source = f"a message ({word(variable.message_type)}) on {word(variable.topic)}"
        else:
            source = f"the result of {word(self._mapping.activation.path)}"
        return Function(
            _function_name(variable),
            ", ".join(["__input", *self._read_by([code], own)]),
            f"The value of {variable.name} after {source}.",
            tuple(lines),
        )

    def tables(self, low_level_names: Iterable[str]) -> list[Table]:
        """Returns the tables of which function belongs to which topic and variable, and of the low-level
        constants."""
        topics: dict[str, list[LocalVariable]] = {}
        response: list[str] = []
        for variable in self._variables.values():
            if variable.source is LocalSource.TOPIC:
                topics.setdefault(variable.topic, []).append(variable)
            elif variable.source is LocalSource.SERVICE_RESPONSE:
                response.append(f"    {literal(variable.name)}: {_function_name(variable)},")
        by_topic: list[str] = []
        for topic, variables in topics.items():
            by_topic.append(f"    {literal(topic)}: {{")
            by_topic += [
                f"        {literal(variable.name)}: {_function_name(variable)}," for variable in variables
            ]
            by_topic.append("    },")
        constants = [f"    {literal(name)}: {name}," for name in low_level_names]
        tables = (("TOPICS", by_topic), ("RESPONSE", response), ("CONSTANTS", constants))
        return [Table(name, tuple(lines)) for name, lines in tables if lines]

    # --- observation ---------------------------------------------------------------------------------

    def observe(self) -> Function:
        """The function from local variables to the response; None where there is none."""
        mapping = self._mapping
        if mapping.response_variable:
            return self._observe_text(mapping.response_variable)
        if not mapping.rules:
            summary = "The response: the skill's only one."
            return Function("observe", "", summary, ('    return "DefaultObservation"',))
        conditions = [
            None if rule.condition is None else self._expression(rule.condition) for rule in mapping.rules
        ]
        lines: list[str] = []
        codes: list[PythonCode] = []
        has_assignments = False
        for rule, code in zip(mapping.rules, conditions, strict=True):
            assigned = [
                (assignment, value)
                for assignment in rule.assignments
                if (value := self._expression(assignment.value))
            ]
            is_last = code is None or code.is_true
            if code is not None and not is_last:
                codes.append(code)
                lines += self.marks.expression("if ", code, ":", 1)
            depth = 1 if is_last else 2
            for assignment, value in assigned:
                codes.append(value)
                has_assignments = True
                lines += self.marks.expression(f"__assign({literal(assignment.path)}, ", value, ")", depth)
            lines.append(f"{' ' * 4 * depth}return {literal(rule.response)}")
            if is_last:
                break
        else:
            lines.append("    return None")
        summary = "The response: that of the first rule that holds."
        reads = self._read_by(codes)
        of_skill = [name for name in _OF_SKILL if any(name in code.reads for code in codes)]
        self.handles_failures = bool(of_skill)
        reads += of_skill
        return Function(
            "observe", ", ".join(["__assign", *reads] if has_assignments else reads), summary, tuple(lines)
        )

    def _observe_text(self, name: str) -> Function:
        if name not in self._variables:
            self._mistake(
                "AOS110", f"the response is the text of {name}, no local variable", self._mapping.span
            )
        summary = f"The response: the text of {word(name)}."
        origin = LineOrigin.of_span(self._mapping.span)
        line = self.marks.line(f"    return None if {name} is None else str({name})", origin)
        return Function("observe", name, summary, (line,))

    def _stop_when(self) -> Function | None:
        """The function that says whether a skill that runs is to be stopped; None where nothing stops it."""
        if self._mapping.stop_when is None:
            return None
        code = self._expression(self._mapping.stop_when)
        if code is None:
            return None
        lines = self.marks.expression("return ", code, "", 1)
        summary = "The skill is stopped as soon as this is True; it is asked after each message."
        if self._mapping.monitor:
            summary = "The skill that runs is stopped when this becomes True; it is asked after each message."
        return Function("stop_when", self._reads([code]), summary, tuple(lines))

    # --- the module's names --------------------------------------------------------------------------

    def shared_code(self) -> list[str]:
        """Returns the code that all mappings share, where this one uses any of it. Call it behind all
        other snippets."""
        code = read_body(self._shared) if self._shared is not None else None
        if isinstance(code, Diagnostic):
            self.diagnostics.append(code)
            return []
        if code is None or not any(snippet.reads & code.assigns for snippet in self._codes):
            return []
        self._codes.append(code)
        return self.marks.body(code, 0)

    def low_level_types(self) -> list[str]:
        """The classes of the low-level document, where this mapping can meet one."""
        if self._low_level is None or not self._meets_constants():
            return []
        types = []
        for type in self._low_level.types:
            fields = "".join(f", {literal(field.name)}" for field in type.fields)
            line = f"{type.name} = low_level_type({literal(type.name)}{fields})"
            types.append(self.marks.line(line, LineOrigin.of_span(type.span)))
        return types

    def constants(self) -> dict[str, list[str]]:
        """The statements that make each low-level constant, where this mapping can meet one."""
        if self._low_level is None or not self._meets_constants():
            return {}
        classes = {type.name for type in self._low_level.types}
        constants = {}
        for constant in self._low_level.constants:
            code = self._kept(read_body(constant.code))
            if code is None:
                continue
            lines = []
            if constant.type not in _PRIMITIVES:
                made = (
                    constant.type if constant.type in classes else f"low_level_type({literal(constant.type)})"
                )
                origin = LineOrigin.of_span(constant.span)
                lines.append(self.marks.line(f"{constant.name} = {made}()", origin))
            constants[constant.name] = lines + self.marks.body(code, 0)
        return constants

    def _meets_constants(self) -> bool:
        """Returns whether a parameter can give this mapping a low-level value, or a snippet names one or
        its type."""
        assert self._low_level is not None
        names = {name for name, _ in self._low_level_names()}
        return any(variable.source is LocalSource.PARAMETER for variable in self._variables.values()) or any(
            code.reads & names for code in self._codes
        )

    def imports(self) -> tuple[list[str], list[ImportPart], list[ImportPart]]:
        """Modules as a whole; names out of modules; and names that an `import *` may have to bring.

        Call it last: the third part goes by what the snippets call. `load` of that part is the name.
        """
        whole: dict[str, str] = {}
        parts: dict[str, ImportPart] = {}
        known = {*self._variables, *dir(builtins), *(name for code in self._codes for name in code.assigns)}
        known.update(name for name, _ in self._low_level_names())
        star = ""
        for imported in self._imports():
            names = self._import_names(imported)
            if names is None:
                continue
            known.update(names)
            text = ", ".join(imported.names)
            origin = LineOrigin.of_span(imported.span)
            if not imported.module:
                whole[text] = self.marks.line(f"import {text}", origin)
                continue
            stand_ins = [_stand_in(name, imported.module) for name in names]
            load = self.marks.line(f"    from {imported.module} import {text}", origin)
            parts[f"{imported.module} {text}"] = ImportPart(load, tuple(stand_ins) or ("pass",))
            if not names:
                star = star or imported.module
        called = sorted({name for code in self._codes for name in code.calls} - known) if star else []
        by_star = [
            ImportPart(name, (f"{name} = stand_in({literal(name)}, {literal(star)})",)) for name in called
        ]
        return list(whole.values()), list(parts.values()), by_star

    def _imports(self) -> Iterable[Import]:
        yield from self._mapping.activation.imports
        for variable in self._variables.values():
            yield from variable.imports

    def _import_names(self, imported: Import) -> list[str] | None:
        """The names an import brings, none for `*`; None if it is not one."""
        names = ", ".join(imported.names)
        text = f"from {imported.module} import {names}" if imported.module else f"import {names}"
        try:
            match ast.parse(text).body:
                case [ast.Import(names=aliases)] | [ast.ImportFrom(level=0, names=aliases)]:
                    brought = [alias.asname or alias.name.partition(".")[0] for alias in aliases]
                case _:
                    raise SyntaxError
        except (SyntaxError, ValueError):
            self._mistake("AOS121", f"{text!r} is not an import", imported.span)
            return None
        for name in brought:
            if name in RESERVED_LOCAL_NAMES or name in self._function_names():
                self._mistake("AOS126", f"the import of {name} hides a generated function", imported.span)
        return [name for name in brought if name != "*"]

    # --- checks --------------------------------------------------------------------------------------

    def _check_names(self) -> None:
        known: set[str] = set()
        for variable in self._mapping.local_variables:
            name = variable.name
            if not _is_usable(name):
                self._mistake("AOS126", f"{name!r} cannot be the name of a local variable", variable.span)
            elif name in known:
                self._mistake("AOS126", f"two local variables are called {name}", variable.span)
            known.add(name)
        for name, span in self._low_level_names():
            if not _is_usable(name):
                self._mistake("AOS126", f"{name!r} cannot be the name of a low-level value", span)

    def _low_level_names(self) -> Iterator[tuple[str, Span]]:
        if self._low_level is not None:
            yield from ((type.name, type.span) for type in self._low_level.types)
            yield from ((constant.name, constant.span) for constant in self._low_level.constants)

    def _function_names(self) -> set[str]:
        return {_function_name(variable) for variable in self._variables.values()}

    def _mistake(self, code: str, message: str, span: Span) -> None:
        self.diagnostics.append(Diagnostic(Severity.ERROR, code, message, span))

    def _expression(self, snippet: Snippet) -> PythonCode | None:
        return self._kept(read_expression(snippet))

    def _kept(self, code: PythonCode | Diagnostic) -> PythonCode | None:
        if isinstance(code, Diagnostic):
            self.diagnostics.append(code)
            return None
        self._codes.append(code)
        return code

    def _reads(self, codes: Iterable[PythonCode]) -> str:
        return ", ".join(self._read_by(codes))

    def _read_by(self, codes: Iterable[PythonCode], also: Iterable[str] = ()) -> list[str]:
        """The local variables that code reads, in the document's order."""
        read = {*also, *(name for code in codes for name in code.reads)}
        return [name for name in self._variables if name in read]


def _function_name(variable: LocalVariable) -> str:
    return f"{variable.name}_from_{'topic' if variable.source is LocalSource.TOPIC else 'response'}"


def _stand_in(name: str, module: str) -> str:
    return f"{name} = stand_in({literal(name)}, {literal(module)})"


def _is_usable(name: str) -> bool:
    return name.isidentifier() and not keyword.iskeyword(name) and name not in RESERVED_LOCAL_NAMES
