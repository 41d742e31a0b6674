"""The names of a bundle that mean the same thing, and their places, in all of its files."""

import re
from collections.abc import Iterable, Iterator, Mapping
from enum import StrEnum
from pathlib import Path

import msgspec
from msgspec.structs import replace

from aos_editor.checking import shown_files
from aos_language.assembly import Assembly, assemble
from aos_language.check.models.blocks import (
    DYNAMIC,
    MONITOR,
    Block,
    assignment_blocks,
    environment_blocks,
    read_block,
    skill_blocks,
)
from aos_language.check.scope import Scope
from aos_language.cpp.keywords import CPP_KEYWORDS, OUR_NAMES, SPECIAL_NAMES, STATES
from aos_language.cpp.snippets import Access, Extent, FaultKind, Mention
from aos_language.document_code import shared_code_of
from aos_language.findings import Findings
from aos_language.local_types import reported_variables
from aos_language.reading.document import array_type
from aos_language.reading.files import read_documents
from aos_protocol.diagnostics import Span
from aos_protocol.documents import AbstractionMapping, LocalSource

_NAME = re.compile(r"[A-Za-z_]\w{0,63}")


class SymbolKind(StrEnum):
    VARIABLE = "state variable"
    VALUE = "enum member"
    TYPE = "type"
    FIELD = "field"
    PARAMETER = "parameter"
    RESPONSE = "response"
    LOCAL = "local variable"
    SKILL = "skill"
    SHARED = "shared code"


class Symbol(msgspec.Struct, frozen=True):
    """A thing with a name. `owner` is the type of a field, and the skill of what belongs to one."""

    kind: SymbolKind
    name: str
    owner: str = ""


class Occurrence(msgspec.Struct, frozen=True):
    """A place where a symbol's name stands."""

    symbol: Symbol
    span: Span
    is_declaration: bool = False


class UnrenamableError(Exception):
    """The symbol cannot get that name; the message says why, for people."""


class Bundle(msgspec.Struct, frozen=True):
    """The occurrences of a bundle, in the order of files and places."""

    occurrences: tuple[Occurrence, ...]
    is_whole: bool
    """True if all of its documents and code could be read."""
    reported: frozenset[str] = frozenset()
    """The state variables that local variables of the same name report."""
    names: frozenset[str] = frozenset()
    """The names of variables, types and enum members."""

    def at(self, file: str, line: int, column: int) -> Occurrence | None:
        """The name at a place (line from 1, column from 0)."""
        for occurrence in self.occurrences:
            start = occurrence.span.column - 1
            if (occurrence.span.file, occurrence.span.line) == (file, line) and (
                start <= column <= start + len(occurrence.symbol.name)
            ):
                return occurrence
        return None

    def of(self, symbol: Symbol) -> list[Occurrence]:
        return [occurrence for occurrence in self.occurrences if occurrence.symbol == symbol]

    def definition(self, symbol: Symbol) -> Occurrence | None:
        return next((occurrence for occurrence in self.of(symbol) if occurrence.is_declaration), None)

    def check_rename(self, symbol: Symbol, new_name: str) -> None:
        """Raises UnrenamableError where the bundle would mean something else, or nothing, with the new
        name."""
        if symbol.kind not in (SymbolKind.VARIABLE, SymbolKind.VALUE):
            raise UnrenamableError("only state variables and enum members can be renamed")
        if not self.is_whole:
            raise UnrenamableError("a document of the bundle cannot be read: mend it first")
        if symbol.kind is SymbolKind.VARIABLE and symbol.name in self.reported:
            raise UnrenamableError(f"a mapping's local variable reports {symbol.name} by its name")
        if not _NAME.fullmatch(new_name) or new_name in CPP_KEYWORDS | OUR_NAMES | SPECIAL_NAMES:
            raise UnrenamableError(f"{new_name!r} cannot be a name")
        if new_name in self.names:
            raise UnrenamableError(f"the bundle has a {new_name} already")


def read_bundle(folder: Path, open_texts: Mapping[str, str]) -> Bundle:
    """The bundle in a folder; `open_texts` are unsaved texts by file name."""
    files, _ = shown_files(folder, open_texts)
    findings = Findings()
    assembly = assemble(
        read_documents(files, findings), findings, bundle=folder.name, has_unread_files=findings.has_errors
    )
    scope = Scope.of(assembly)
    found = [*_declarations(assembly), *_code(assembly, scope), *_mappings(assembly, scope)]
    blocks = [*_blocks(assembly)]
    is_whole = not findings.has_errors and not any(
        fault.kind is not FaultKind.SYNTAX for _, block in blocks for fault in read_block(block).faults
    )
    unique: dict[tuple[Symbol, Span], Occurrence] = {}
    for occurrence in sorted(found, key=lambda occurrence: (occurrence.span, not occurrence.is_declaration)):
        unique.setdefault((occurrence.symbol, occurrence.span), occurrence)
    environment = assembly.environment
    reported: set[str] = set()
    if environment is not None:
        for mapping in assembly.mappings.values():
            reported |= {*reported_variables(mapping, environment)}
    names = {*scope.variables, *scope.enum_values, *scope.enums, *scope.compounds}
    return Bundle(tuple(unique.values()), is_whole, frozenset(reported), frozenset(names))


def _declarations(assembly: Assembly) -> Iterator[Occurrence]:
    def declared(kind: SymbolKind, name: str, span: Span, owner: str = "") -> Occurrence:
        return Occurrence(Symbol(kind, name, owner), span, is_declaration=True)

    def typed(name: str, span: Span | None) -> Iterator[Occurrence]:
        if span is not None:
            yield Occurrence(Symbol(SymbolKind.TYPE, name), span)

    environment = assembly.environment
    types: set[str] = set()
    if environment is not None:
        types |= {enum.name for enum in environment.enums}
        types |= {compound.name for compound in environment.compounds}
        for enum in environment.enums:
            yield declared(SymbolKind.TYPE, enum.name, enum.span)
            for value, span in zip(enum.values, enum.value_spans, strict=False):
                yield declared(SymbolKind.VALUE, value, span)
        for compound in environment.compounds:
            yield declared(SymbolKind.TYPE, compound.name, compound.span)
            for field in compound.fields:
                yield declared(SymbolKind.FIELD, field.name, field.span, compound.name)
                yield from typed(field.type, field.type_span if field.type in types else None)
        if (snippet := environment.shared_code) is not None:
            shared = shared_code_of(environment)
            for item in (*shared.names, *shared.functions):
                yield declared(SymbolKind.SHARED, item.name, snippet.at(item.name_extent.start))
        for variable in environment.variables:
            yield declared(SymbolKind.VARIABLE, variable.name, variable.span)
            yield from typed(variable.type, variable.type_span if variable.type in types else None)
            yield from typed(variable.index_enum, variable.index_span)
    for model in assembly.models.values():
        yield declared(SymbolKind.SKILL, model.name, Span(model.span.file, 1, 1))
        for parameter in model.parameters:
            yield declared(SymbolKind.PARAMETER, parameter.name, parameter.span, model.name)
            yield from typed(parameter.type, parameter.type_span if parameter.type in types else None)


# --- C++ ---


def _blocks(assembly: Assembly) -> Iterator[tuple[str, Block]]:
    """All model code, with the skill or the monitor it belongs to."""
    if (environment := assembly.environment) is not None:
        others = replace(environment, monitors=())
        yield from (("", block) for block in environment_blocks(others))
        for monitor in environment.monitors:
            yield from ((monitor.name, block) for block in assignment_blocks(MONITOR, monitor.code))
    for model in assembly.models.values():
        yield from ((model.name, block) for block in skill_blocks(model))


def _code(assembly: Assembly, scope: Scope) -> Iterator[Occurrence]:
    monitors = {mapping.monitor: mapping for mapping in assembly.monitors.values()}
    for skill, block in _blocks(assembly):
        mapping = monitors.get(skill) if block.role is MONITOR else assembly.mappings.get(skill)
        is_telling = mapping is not None and block.role in (DYNAMIC, MONITOR)
        responses = {rule.response for rule in mapping.rules} if mapping and is_telling else set()
        yield from _BlockNames(skill, block, scope, responses).occurrences()


class _BlockNames:
    """The names in one snippet of model code."""

    def __init__(self, skill: str, block: Block, scope: Scope, responses: set[str]) -> None:
        self._skill = skill
        self._block = block
        self._scope = scope
        self._responses = responses
        self._cpp = read_block(block)
        self._own = self._cpp.declared

    def occurrences(self) -> Iterator[Occurrence]:
        for mention in self._cpp.mentions:
            yield from self._of_mention(mention)
        for name, extent in self._cpp.types:
            if name in self._scope.enums or name in self._scope.compounds:
                yield self._at(Symbol(SymbolKind.TYPE, name), extent)

    def _of_mention(self, mention: Mention) -> Iterator[Occurrence]:
        root, scope = mention.path[0], self._scope
        if root in scope.shared.all_names and (self._block.is_declarations or root not in self._own):
            yield self._at(Symbol(SymbolKind.SHARED, root), mention.root)
            return
        if root in self._own or (mention.access is Access.CALL and root not in STATES):
            return
        if root in STATES:
            yield from self._of_state(mention)
        elif root in self._block.constants:
            yield self._at(Symbol(SymbolKind.PARAMETER, root, self._skill), mention.root)
            yield from self._fields(mention, self._block.constants[root], start=1)
        elif root in self._block.names:
            yield from self._fields(mention, self._block.names[root], start=1)
        elif self._block.role.sees_chosen_action and root in scope.skills:
            yield self._at(Symbol(SymbolKind.SKILL, root), mention.root)
            yield from self._of_chosen(mention, root)
        elif root in self._responses:
            yield self._at(Symbol(SymbolKind.RESPONSE, root, self._skill), mention.root)
        elif root in scope.enum_values:
            yield self._at(Symbol(SymbolKind.VALUE, root), mention.root)
        elif root in scope.enums:
            yield self._at(Symbol(SymbolKind.TYPE, root), mention.root)
            if len(mention.path) > 1 and mention.path[1] in scope.enum_values:
                yield from self._part(Symbol(SymbolKind.VALUE, mention.path[1]), mention, 1)

    def _of_state(self, mention: Mention) -> Iterator[Occurrence]:
        variable = self._scope.variables.get(mention.path[1]) if len(mention.path) > 1 else None
        if variable is not None:
            yield from self._part(Symbol(SymbolKind.VARIABLE, variable.name), mention, 1)
            yield from self._fields(mention, variable.type, start=2)

    def _of_chosen(self, mention: Mention, skill: str) -> Iterator[Occurrence]:
        types = {parameter.name: parameter.type for parameter in self._scope.skills[skill].parameters}
        if len(mention.path) > 1 and mention.path[1] in types:
            yield from self._part(Symbol(SymbolKind.PARAMETER, mention.path[1], skill), mention, 1)
            yield from self._fields(mention, types[mention.path[1]], start=2)

    def _fields(self, mention: Mention, kind: str, *, start: int) -> Iterator[Occurrence]:
        for index in range(start, len(mention.path)):
            part = mention.path[index]
            if part == "[]":
                continue
            compound = self._scope.compounds.get(kind)
            types = {field.name: field.type for field in compound.fields} if compound is not None else {}
            if part not in types:
                return
            yield from self._part(Symbol(SymbolKind.FIELD, part, kind), mention, index)
            kind, _, _ = array_type(types[part])

    def _part(self, symbol: Symbol, mention: Mention, index: int) -> Iterator[Occurrence]:
        """The place of a path's part: the words of the text between its start and its end, in order."""
        text = self._cpp.text(mention.extent)
        before = sum(part == symbol.name for part in mention.path[:index])
        places = [word for word in re.finditer(r"\w+", text) if word.group() == symbol.name]
        if before < len(places):
            start = mention.extent.start + places[before].start()
            yield Occurrence(symbol, self._block.snippet.at(start))

    def _at(self, symbol: Symbol, extent: Extent) -> Occurrence:
        return Occurrence(symbol, self._block.snippet.at(extent.start))


# --- mappings ---


def _mappings(assembly: Assembly, scope: Scope) -> Iterator[Occurrence]:
    for mapping in (*assembly.mappings.values(), *assembly.monitors.values()):
        if mapping.is_derived:
            # It stands nowhere. What gives a response first is where its name is looked for.
            for rule in mapping.rules:
                yield Occurrence(Symbol(SymbolKind.RESPONSE, rule.response, mapping.name), rule.span, True)
            continue
        owner = mapping.monitor or mapping.name
        for rule in mapping.rules:
            yield Occurrence(Symbol(SymbolKind.RESPONSE, rule.response, owner), rule.span, True)
            for assignment in rule.assignments:
                prefix = "state." if assignment.path.startswith("state.") else ""
                name = assignment.path.removeprefix(prefix).split(".")[0]
                column = assignment.span.column + len(prefix)
                span = replace(assignment.span, column=column)
                if name in scope.variables:
                    yield Occurrence(Symbol(SymbolKind.VARIABLE, name), span)
        for variable in mapping.local_variables:
            yield Occurrence(Symbol(SymbolKind.LOCAL, variable.name, mapping.name), variable.span, True)
            if variable.source is LocalSource.PARAMETER and variable.source_span is not None:
                name = variable.parameter_path.split(".")[0]
                yield Occurrence(Symbol(SymbolKind.PARAMETER, name, mapping.name), variable.source_span)
        yield from _python(mapping)


def _python(mapping: AbstractionMapping) -> Iterator[Occurrence]:
    """Local variables in the expressions and the code of a mapping, by their words."""
    conditions = (rule.condition for rule in mapping.rules)
    codes = (variable.code for variable in mapping.local_variables)
    fields = (field.value for field in mapping.activation.fields)
    names = {variable.name for variable in mapping.local_variables}
    for snippet in (*conditions, *codes, *fields, mapping.stop_when):
        for number, line in enumerate(snippet.code.split("\n") if snippet is not None else (), start=1):
            for match in re.finditer(r"(?<![\w.\"'])[A-Za-z_]\w*(?![\"'])", line.partition("#")[0]):
                if match.group() in names and snippet is not None:
                    symbol = Symbol(SymbolKind.LOCAL, match.group(), mapping.name)
                    yield Occurrence(symbol, snippet.locate(number, match.start() + 1))


def files_of(occurrences: Iterable[Occurrence]) -> dict[str, list[Occurrence]]:
    by_file: dict[str, list[Occurrence]] = {}
    for occurrence in occurrences:
        by_file.setdefault(occurrence.span.file, []).append(occurrence)
    return by_file
