"""The C++ of environment and skills: does each snippet stay in its function, and mean what exists?"""

from collections import Counter
from collections.abc import Iterable

import msgspec

from aos_language.check.models.blocks import (
    DEFAULT,
    PARAMETERS,
    PRECONDITION,
    Block,
    environment_blocks,
    read_block,
    skill_blocks,
)
from aos_language.check.models.built_ins import BUILT_INS, calls_of_no_built_in, check_built_in, check_weights
from aos_language.check.models.mentions import LITERAL_NAMES, MentionCheck, check_objects, listing
from aos_language.check.scope import Scope
from aos_language.check.shared_calls import check_shared_call
from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.snippets import Call, Cpp, DeclarationKind, Extent, FaultKind, read_cpp
from aos_language.cpp.unset import unset_reads
from aos_language.findings import Findings
from aos_protocol.diagnostics import Mend, Span
from aos_protocol.documents import Assignment, Environment, SkillModel


def check_environment_code(environment: Environment, scope: Scope, findings: Findings) -> None:
    blocks = (
        environment.initial_belief,
        environment.extrinsic_changes,
        environment.state_heuristic,
        environment.print_state,
        *(special.code for special in environment.special_states),
        *(monitor.code for monitor in environment.monitors),
    )
    _check_blocks(blocks, tuple(environment_blocks(environment)), scope, findings)


def check_skill_code(model: SkillModel, scope: Scope, findings: Findings) -> None:
    blocks = (
        model.possible_parameters,
        model.precondition,
        model.rollout_policy,
        model.execution_time,
        model.dynamic_model,
        model.state_given_observation,
    )
    _check_blocks(blocks, tuple(skill_blocks(model)), scope, findings)


def _check_blocks(
    blocks: Iterable[tuple[Assignment, ...]], pieces: tuple[Block, ...], scope: Scope, findings: Findings
) -> None:
    """The sections of a document, and the blocks that they consist of."""
    for block in blocks:
        _check_loops(block, scope, findings)
    around = _Around(_temporary_enums(blocks), _declared_names(pieces), _names_of_several(pieces))
    for piece in pieces:
        _BlockCheck(piece, scope, findings, around).run()


def check_block(block: Block, scope: Scope, findings: Findings) -> None:
    """A block that stands alone."""
    _BlockCheck(block, scope, findings, _Around({}, frozenset(), frozenset())).run()


def _enum_sizes(cpp: Cpp) -> dict[str, int]:
    """The enums that code declares, with how many values they have."""
    values = [
        declaration.type for declaration in cpp.declarations if declaration.kind is DeclarationKind.ENUMERATOR
    ]
    enums = (declaration.name for declaration in cpp.declarations if declaration.kind is DeclarationKind.ENUM)
    return {name: values.count(name) for name in enums}


def _temporary_enums(blocks: Iterable[tuple[Assignment, ...]]) -> dict[str, int]:
    """The enums that temporary variables declare, with how many values they have."""
    temporaries = (assignment.temporary for block in blocks for assignment in block)
    return {
        temporary.enum_name: len(temporary.enum_values)
        for temporary in temporaries
        if temporary and temporary.enum_values
    }


def _declared_names(pieces: Iterable[Block]) -> frozenset[str]:
    """Returns all names that the document's code declares: a name may be used in a later snippet of its
    section."""
    return frozenset(declaration.name for piece in pieces for declaration in read_block(piece).declarations)


def _names_of_several(pieces: Iterable[Block]) -> frozenset[str]:
    counted = Counter(
        name for piece in pieces for name in {use.path[0] for use in read_block(piece).mentions}
    )
    return frozenset(name for name, count in counted.items() if count > 1)


def _check_loops(block: tuple[Assignment, ...], scope: Scope, findings: Findings) -> None:
    for assignment in block:
        if assignment.temporary is not None and not assignment.temporary.enum_name:
            temporary = assignment.temporary
            if scope.has_environment and (unknown := scope.unknown_type_name(temporary.type)):
                findings.unknown(unknown, scope.type_names, f"unknown type `{unknown}`", temporary.span)
        for loop in (*assignment.over_previous, *assignment.over_next):
            if scope.has_environment and loop.type not in scope.compounds:
                message = f"unknown compound type `{loop.type}`"
                otherwise = "A loop runs over a compound type"
                findings.unknown(loop.type, scope.compounds, message, loop.span, otherwise)
            elif scope.lacks_objects(loop.type):
                check_objects(loop.type, "this loop has no rounds", loop.span, findings)


class _Around(msgspec.Struct, frozen=True):
    """The document's other code: its enums with how many values they have, all names that it declares, and
    those that several of its snippets use."""

    enum_sizes: dict[str, int]
    declared: frozenset[str]
    of_several: frozenset[str]


class _BlockCheck:
    """One snippet against the names of the project."""

    def __init__(self, block: Block, scope: Scope, findings: Findings, around: _Around) -> None:
        self._block = block
        self._scope = scope
        self._findings = findings
        self._cpp = read_block(block)
        self._enum_sizes = {name: len(enum.values) for name, enum in scope.enums.items()}
        self._enum_sizes |= _enum_sizes(scope.shared.cpp) | around.enum_sizes
        self._declared = around.declared | scope.shared.all_names
        self._of_several = around.of_several
        self._locals = {declaration.name: declaration.type for declaration in self._cpp.declarations}
        self._mentions = MentionCheck(block, self._cpp, scope, self._declared, findings)

    def run(self) -> None:
        for fault in self._cpp.faults:
            if fault.kind is FaultKind.SYNTAX and self._block.is_declarations:
                hint = fault.hint or "Nothing of shared code can be used until all of it is C++"
                self._findings.error("AOS108", f"{fault.message} in C++", self._span(fault.extent), hint)
            elif fault.kind is FaultKind.SYNTAX:
                message, hint = f"{fault.message} in C++", fault.hint or "The compiler will tell more"
                self._findings.warning("AOS108", message, self._span(fault.extent), hint)
            else:
                span = self._span(fault.extent)
                mend = Mend(span, 1, fault.instead) if fault.instead else None
                self._findings.error("AOS108", fault.message, span, fault.hint, mend)
        if any(fault.kind is not FaultKind.SYNTAX for fault in self._cpp.faults):
            for call in calls_of_no_built_in(self._cpp):
                check_built_in(call, self._cpp.code, (), self._span, self._findings)
            return
        if self._block.is_declarations and self._cpp.faults:
            return
        is_idle = self._is_idle_default()
        if not is_idle:
            self._check_semicolons()
        for mention in self._cpp.mentions:
            self._mentions.check(mention)
        self._check_fixed_draws()
        self._check_calls()
        self._check_lone_name()
        self._check_conditions()
        if self._block.is_declarations:
            for body in self._scope.shared.bodies():
                self._check_unset(read_cpp(body))
        elif not is_idle:
            self._check_idle()
            if not self._block.is_expression:
                self._check_unset(self._cpp)

    def _check_fixed_draws(self) -> None:
        """Warns of a draw in what makes the grounded actions."""
        variable = self._scope.variables.get(self._block.sets)
        makes_values = self._block.role is DEFAULT and variable is not None and variable.is_parameter_value
        if not makes_values and self._block.role is not PARAMETERS:
            return
        for mention in self._cpp.mentions:
            is_draw = mention.path[0] in DRAW_SOURCES and mention.path[-1] in BUILT_INS["AOSUtils"]
            if is_draw or mention.path[0] in self._scope.shared.drawing:
                message = "actions are made once, from the likeliest outcome of this draw"
                hint = "Draw in the initial belief, and let a precondition look at it"
                self._findings.warning("AOS124", message, self._span(mention.root), hint)

    def _is_idle_default(self) -> bool:
        """Warns of code for a variable's default that sets nothing."""
        cpp, name = self._cpp, self._block.sets
        if not name or self._block.is_expression or cpp.is_empty or cpp.calls or any(cpp.writes()):
            return False
        hint = f"Write `state.{name} = {cpp.code.strip().rstrip(';')};`"
        span = self._block.snippet.span
        self._findings.warning("AOS149", f"this code for the default of {name} sets nothing", span, hint)
        return True

    def _check_idle(self) -> None:
        for operator in self._cpp.idle_operators:
            span = self._span(operator)
            if self._cpp.code[operator.start] == ",":
                hint = "A decimal is written with a point"
                message, mend = "the number behind this comma does nothing", Mend(span, 1, ".")
            elif self._cpp.code[operator.start] == "+":
                message, hint, mend = "this `+` does nothing", "To add, write `+=`", None
            else:
                hint = "To set what stands before it, write `=`"
                message, mend = "this comparison does nothing", Mend(span, 2, "=")
            report = self._findings.error if self._block.is_expression else self._findings.warning
            report("AOS149", message, span, hint, mend)
        name = "__meetPrecondition" if self._block.role is PRECONDITION else "NAME"
        for value in self._cpp.idle_values:
            hint = f"To set a variable, write `{name} = {self._cpp.text(value)};`"
            self._findings.warning("AOS149", "this statement does nothing", self._span(value), hint)
        for odd in self._cpp.odd_parts:
            is_of_enums = {*odd.of_enums} <= {*self._scope.enum_values} - {*self._locals}
            if is_of_enums and odd.local not in self._of_several:
                self._findings.warning("AOS149", odd.message, self._span(odd.extent), odd.hint)

    def _check_conditions(self) -> None:
        """A condition that sets something; where it may not write that, this has been told already."""
        for left, operator in self._cpp.set_in_conditions if self._block.role is not DEFAULT else ():
            text = self._cpp.text(left)
            if text.partition(".")[0].strip() in {*STATES} - {*self._block.role.writes}:
                continue
            span = self._span(operator)
            mend = Mend(span, 1, "==")
            self._findings.warning(
                "AOS149", f"this condition sets `{text}`", span, "To compare, write `==`", mend
            )

    def _check_unset(self, cpp: Cpp) -> None:
        for read in unset_reads(cpp, frozenset(self._scope.enums)):
            report = self._findings.error if read.never else self._findings.warning
            which = "has no value" if read.never else "may have no value"
            hint = f"Declare it with one: `{read.type} {read.name} = ...;`"
            report("AOS143", f"`{read.name}` {which} here", self._span(read.extent), hint)

    def _check_semicolons(self) -> None:
        idle = {value.end for value in self._cpp.idle_values}
        for offset in [each for each in self._cpp.missing_semicolons if each not in idle]:
            span = self._block.snippet.at(offset)
            mend = Mend(span, 0, ";")
            self._findings.warning("AOS127", "a semicolon is missing here", span, "It is put in", mend)

    def _check_calls(self) -> None:
        self._enum_sizes |= _enum_sizes(self._cpp)
        for call in self._cpp.calls:
            declared = self._declared.union(self._locals, self._block.names)
            check_built_in(call, self._cpp.code, declared, self._span, self._findings)
            if call.name and call.name[0] not in {*self._locals, *self._block.names}:
                check_shared_call(call, self._scope.shared, self._span(call.function), self._findings)
            if len(call.name) == 2 and call.name[1] in BUILT_INS.get(call.name[0], ()):
                self._check_enum(call)
                check_weights(call, self._cpp.code, self._enum_sizes, self._span, self._findings)

    def _check_enum(self, call: Call) -> None:
        """SampleDiscrete takes weights, and before them an enum or the values that are drawn."""
        if call.name[1] != "SampleDiscrete":
            return
        place = call.arguments[0] if call.arguments else call.function
        name = self._cpp.text(place).strip()
        is_list = name.startswith("{")
        if len(call.arguments) not in (1, 2) or name[:1].isdigit() or (is_list and len(call.arguments) == 2):
            right = (
                "the values with their type: `vector<Type>{...}`"
                if is_list
                else "`AOS.SampleDiscrete(Enum, {0.5, 0.5})`"
            )
            message = "SampleDiscrete takes an enum or values, and a list of weights"
            self._findings.error("AOS110", message, self._span(place), f"Write {right}")
            return
        if len(call.arguments) == 1:
            if name in self._enum_sizes:
                message, hint = "the weights are missing", f"Write `AOS.SampleDiscrete({name}, {{0.5, 0.5}})`"
                self._findings.error("AOS110", message, self._span(place), hint)
            return
        declared = self._cpp.declared | self._declared
        if name.isidentifier() and name not in self._enum_sizes and name not in declared:
            otherwise = listing("The enums are", sorted(self._enum_sizes))
            self._findings.unknown(
                name, self._enum_sizes, f"unknown enum `{name}`", self._span(place), otherwise
            )

    def _check_lone_name(self) -> None:
        """A default or condition that is one name must be an enum's value, declared, or low-level."""
        mentions = self._cpp.mentions
        if not self._block.is_expression or len(mentions) != 1 or len(mentions[0].path) != 1:
            return
        name = mentions[0].path[0]
        known = {*self._scope.enum_values, *self._scope.low_level_names, *self._block.names}
        known |= self._declared
        if name == self._block.snippet.code.strip() and not name.startswith("_") and name not in known:
            if name in LITERAL_NAMES or name.isupper():
                return
            message = f"unknown name `{name}`"
            self._findings.unknown(name, {"true", "false", *known}, message, self._span(mentions[0].root))

    def _span(self, extent: Extent) -> Span:
        return self._block.snippet.at(extent.start)
