"""Document code: which copies of the state each section sees and changes, and its functions."""

import copy
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Self

import msgspec
from msgspec.structs import replace

from aos_language.cpp.goal_conditions import Edits, counted_conditions
from aos_language.cpp.loops import Scope, loops_of
from aos_language.cpp.shared import SharedCode
from aos_language.cpp.snippets import (
    Cpp,
    DeclarationKind,
    FaultKind,
    blanked,
    read_cpp,
    read_cpp_declarations,
    read_cpp_expression,
    strip_comments,
)
from aos_language.document_code import snippets_of
from aos_language.findings import Findings
from aos_protocol.diagnostics import Span
from aos_protocol.documents import (
    AbstractionMapping,
    Assignment,
    EnumType,
    Iteration,
    Project,
    Snippet,
    TemporaryVariable,
)
from aos_solver.emission.lowering.cpp_library import instead_of_unrepeatable, unrepeatable_names
from aos_solver.emission.lowering.types import Types
from aos_solver.emission.program import DeclaredVariable, EnumVariable, Loop, Piece, Section, Statement
from aos_solver.emission.rewriting.rewrite import NO_LOOPS, EnumValues, LoopsOfPiece, Rewriting, rewrite


class Phase(msgspec.Struct, frozen=True):
    """The rights of a kind of section: the copies that loops run over, and the copies it may change."""

    title: str
    next_copy: str = ""
    changes: frozenset[str] = frozenset()
    previous_copy: str = "state"


_UNCOUNTED: Mapping[str, Edits] = {}
_LoopsByCode = Mapping[int, LoopsOfPiece]
"""The loops by the identity of the snippet, since two snippets of a section may be equal."""

BELIEF = Phase("the initial belief", changes=frozenset({"state"}))
EXTRINSIC = Phase("extrinsic changes", "state_", frozenset({"state_"}))
DYNAMIC = Phase("a dynamic model", "state__", frozenset({"state__"}))
GIVEN = Phase("a state given an observation", "state___", frozenset({"state___"}), "state__")
LOOKING = Phase("this section")


def sections_of(project: Project) -> Iterator[tuple[Phase, tuple[Assignment, ...]]]:
    """All code of a project, by phase."""
    environment = project.environment
    yield BELIEF, environment.initial_belief
    yield EXTRINSIC, environment.extrinsic_changes
    yield LOOKING, environment.state_heuristic
    yield LOOKING, environment.print_state
    for special in environment.special_states:
        yield LOOKING, special.code
    for monitor in environment.monitors:
        yield LOOKING, monitor.code
    for model in (skill.model for skill in project.skills):
        yield LOOKING, model.possible_parameters
        yield LOOKING, model.precondition
        yield LOOKING, model.execution_time
        yield LOOKING, model.rollout_policy
        yield DYNAMIC, model.dynamic_model
        yield GIVEN, model.state_given_observation


class Pieces:
    """Makes pieces and numbers them; refuses code that could leave its function or cannot be replayed."""

    def __init__(self, findings: Findings, told_apart: Mapping[Snippet, Mapping[int, str]]) -> None:
        """`told_apart`: draws of a kind, by where their calls start, each with the kind's word."""
        self.made: list[Piece] = []
        self.identifiers: set[str] = set()
        self._loops = 0
        self._findings = findings
        self._told_apart = told_apart

    def code(self, snippet: Snippet, rewriting: Rewriting, of_loops: LoopsOfPiece = NO_LOOPS) -> Piece:
        return self._make(
            snippet, read_cpp(snippet.code), rewriting, self._numbered(of_loops), is_statements=True
        )

    def _numbered(self, of_loops: LoopsOfPiece) -> LoopsOfPiece:
        first = self._loops + 1
        self._loops += len(of_loops.loops)
        return replace(of_loops, first=first)

    def expression(self, snippet: Snippet, rewriting: Rewriting) -> Piece:
        return self._make(snippet, read_cpp_expression(snippet.code), rewriting)

    def declarations(
        self, snippet: Snippet, shared: SharedCode, rewriting: Rewriting, *, late: bool
    ) -> Piece | None:
        """The shared code that is `late`, or stands before the compound types; None for nothing."""
        if not any(item.is_late == late for item in (*shared.names, *shared.functions)):
            return None
        cpp = read_cpp_declarations(shared.without(late=not late))
        functions = shared.functions if late else ()
        read = loops_of(cpp, _drawing(shared.drawing), are_declarations=True)
        of_loops = self._numbered(LoopsOfPiece(read.loops, read.unset if read.loops else ()))
        text, edits = rewrite(cpp, rewriting, {}, functions, of_loops)
        text = "\n".join(line if line.strip() else "" for line in text.split("\n"))
        piece = Piece(len(self.made) + 1, snippet, text, edits, is_declarations=True)
        self.made.append(piece)
        return piece

    def _make(
        self,
        snippet: Snippet,
        cpp: Cpp,
        rewriting: Rewriting,
        of_loops: LoopsOfPiece = NO_LOOPS,
        *,
        is_statements: bool = False,
    ) -> Piece:
        self.check(snippet, cpp)
        is_safe = all(fault.kind is FaultKind.SYNTAX for fault in cpp.faults)
        told_apart = self._told_apart.get(snippet, {})
        text, edits = rewrite(cpp, rewriting, told_apart, of_loops=of_loops) if is_safe else ("", ())
        piece = Piece(len(self.made) + 1, snippet, text, edits, is_statements=is_statements)
        self.made.append(piece)
        return piece

    def check(self, snippet: Snippet, cpp: Cpp) -> None:
        """Reports AOS108 and AOS124 for what could leave its function, and what cannot be replayed."""
        for fault in cpp.faults:
            if fault.kind is not FaultKind.SYNTAX:
                span = snippet.at(fault.extent.start)
                self._findings.error("AOS108", fault.message, span)
        code = blanked(strip_comments(cpp.code), cpp.literals)
        self.identifiers.update(re.findall(r"[A-Za-z_]\w*", code))
        functions = (call.name for call in cpp.calls if len(call.name) == 1 or call.name[:1] == ("std",))
        named = {part for name in functions for part in name}
        named |= {part for name, _ in cpp.types for part in name.split("::")}
        own = cpp.declared
        for name in unrepeatable_names(frozenset(named - own), code):
            at = re.search(rf"\b{re.escape(name)}\b", code)
            start = at.start() if at is not None else 0
            span = snippet.at(start)
            message = f"`{name}` makes a step that cannot be repeated exactly"
            self._findings.error("AOS124", message, span, instead_of_unrepeatable(name))


class SectionLowering:
    """Lowers sections into the functions that they become."""

    def __init__(
        self,
        types: Types,
        pieces: Pieces,
        object_types: frozenset[str],
        enums: Iterable[EnumType],
        shared: SharedCode,
        findings: Findings,
    ) -> None:
        enums = tuple(enums)
        values = frozenset(value for enum in enums for value in enum.values)
        known = {**{enum.name: None for enum in enums}, **_local_enums([shared.cpp])}
        self._types = types
        self._pieces = pieces
        self._findings = findings
        self.outside = Rewriting(object_types, known, values, shared.drawing)
        """The meanings of names in code that stands alone."""

    def of(self, mapping: AbstractionMapping) -> Self:
        """The lowering of the sections of this mapping's skill or monitor."""
        names = frozenset(rule.response for rule in mapping.rules) & self.outside.values
        its = copy.copy(self)
        its.outside = replace(self.outside, responses=names)
        return its

    def goal_conditions(self, phase: Phase, assignments: tuple[Assignment, ...]) -> Section | None:
        """The section once more, which counts the conditions of rewards and goals; None if they are few."""
        read = [cpp for _, cpp in snippets_of(assignments)]
        counted = counted_conditions(read)
        edits = {cpp.code: edits for cpp, edits in zip(read, counted, strict=False)}
        return self.section(phase, assignments, edits) if counted else None

    def goal_condition(self, condition: Snippet) -> Piece | None:
        """The same of a special state's condition."""
        (edits,) = counted_conditions([read_cpp_expression(condition.code)], is_expression=True) or ((),)
        rewriting = replace(self.outside, counted={condition.code: edits})
        return self._pieces.expression(condition, rewriting) if edits else None

    def section(
        self, phase: Phase, assignments: tuple[Assignment, ...], counted: Mapping[str, Edits] = _UNCOUNTED
    ) -> Section | None:
        """The section's function; None if there is nothing in it."""
        read = list(snippets_of(assignments))
        if not any(a.temporary for a in assignments) and all(cpp.is_empty for _, cpp in read):
            return None
        enums = {**self.outside.enums, **_local_enums(cpp for _, cpp in read)}
        rewriting = replace(self.outside, enums=enums, counted=counted)
        names = frozenset(mention.path[0] for _, cpp in read for mention in cpp.mentions)
        scope = _drawing(self.outside.drawing).with_variables(phase.changes | (names & _RESULTS))
        of_loops = _loops_of(assignments, scope)
        statements = [part for a in assignments for part in self._assignment(phase, a, rewriting, of_loops)]
        return Section(tuple(statements), names | _looped_copies(phase, assignments))

    def _assignment(
        self, phase: Phase, assignment: Assignment, rewriting: Rewriting, of_loops: _LoopsByCode
    ) -> Iterator[Statement]:
        if assignment.temporary is not None:
            yield self._temporary(assignment.temporary)
        if assignment.over_previous:
            is_reference = phase.previous_copy in phase.changes
            yield self._loop(assignment.over_previous, phase.previous_copy, is_reference, rewriting, of_loops)
        if assignment.over_next:
            if phase.next_copy:
                yield self._loop(assignment.over_next, phase.next_copy, True, rewriting, of_loops)
            else:
                self._no_next_state(phase, assignment.over_next[0].span)
        if assignment.code is not None and not read_cpp(assignment.code.code).is_empty:
            yield self._pieces.code(assignment.code, rewriting, of_loops.get(id(assignment.code), NO_LOOPS))

    def _temporary(self, variable: TemporaryVariable) -> Statement:
        if variable.enum_values:
            return EnumVariable(variable.name, variable.enum_name, variable.enum_values)
        return DeclaredVariable(variable.name, self._types.plain(variable.type, variable.span))

    def _loop(
        self,
        loops: tuple[Iteration, ...],
        state_copy: str,
        is_reference: bool,
        rewriting: Rewriting,
        of_loops: _LoopsByCode,
    ) -> Loop:
        first, rest = loops[0], loops[1:]
        condition = body = None
        if first.condition is not None and not read_cpp_expression(first.condition.code).is_empty:
            condition = self._pieces.expression(first.condition, rewriting)
        if first.body is not None and not read_cpp(first.body.code).is_empty:
            body = self._pieces.code(first.body, rewriting, of_loops.get(id(first.body), NO_LOOPS))
        inner = self._loop(rest, state_copy, is_reference, rewriting, of_loops) if rest else None
        return Loop(first.type, first.item, state_copy, is_reference, condition, body, inner)

    def _no_next_state(self, phase: Phase, span: Span) -> None:
        hint = "Use IteratePreviousStateVars"
        self._findings.error("AOS123", f"there is no next state in {phase.title} to iterate over", span, hint)


_RESULTS = frozenset({
    "__heuristicValue", "__isFailureState", "__isGoalState", "__meetPrecondition", "__moduleExecutionTime",
    "__moduleResponse", "__moduleResponseStr", "__possibleParameters", "__reward", "__stopEvaluatingState",
})  # fmt: skip


def _drawing(functions: frozenset[str]) -> Scope:
    """Code that may call functions that draw."""
    return Scope(drawing=Scope().drawing | functions)


def _loops_of(assignments: tuple[Assignment, ...], scope: Scope) -> _LoopsByCode:
    """The loops in which a section draws. One snippet sees the variables of those before it."""
    found: dict[int, LoopsOfPiece] = {}
    for assignment in assignments:
        if assignment.temporary is not None:
            scope = scope.with_variables([assignment.temporary.name])
        for loops in (assignment.over_previous, assignment.over_next):
            inside = scope
            for loop in loops:
                inside = inside.with_variables([loop.item])
                if loop.body is not None:
                    read = loops_of(read_cpp(loop.body.code), inside)
                    found[id(loop.body)] = LoopsOfPiece(read.loops, read.unset)
        if assignment.code is not None:
            read = loops_of(read_cpp(assignment.code.code), scope)
            found[id(assignment.code)] = LoopsOfPiece(read.loops, read.unset)
            scope = read.after
    return found if any(piece.loops for piece in found.values()) else {}


def _looped_copies(phase: Phase, assignments: tuple[Assignment, ...]) -> frozenset[str]:
    copies = {phase.previous_copy for assignment in assignments if assignment.over_previous}
    copies |= {phase.next_copy for assignment in assignments if assignment.over_next}
    return frozenset(copies)


def _local_enums(snippets: Iterable[Cpp]) -> dict[str, EnumValues]:
    """The enums that a section's code declares; with their values where those are not 0, 1, 2, ..."""
    enums: dict[str, EnumValues] = {}
    for cpp in snippets:
        for enum in cpp.declarations:
            if enum.kind is not DeclarationKind.ENUM or not enum.name:
                continue
            values = [
                d for d in cpp.declarations if d.kind is DeclarationKind.ENUMERATOR and d.type == enum.name
            ]
            is_numbered = any(cpp.code[v.extent.end :].lstrip().startswith("=") for v in values)
            enums[enum.name] = tuple(f"{enum.name}::{v.name}" for v in values) if is_numbered else None
    return enums
