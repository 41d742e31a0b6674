"""The C++ of environment and skills: does each snippet stay in its function, and mean what exists?"""

from __future__ import annotations

import re
from collections.abc import Iterable

import msgspec

from aos_language.check.blocks import Block, environment_blocks, skill_blocks
from aos_language.check.built_ins import BUILT_INS, check_built_in
from aos_language.check.scope import NUMBERS, STATE_COPIES, Scope, ValueType
from aos_language.check.subscripts import subscripts_of
from aos_language.check.weights import check_weights
from aos_language.cpp.keywords import COMPILER_NAMES, SPECIAL_NAMES
from aos_language.cpp.snippets import (
    Access,
    Call,
    Cpp,
    DeclarationKind,
    Extent,
    FaultKind,
    Mention,
    read_cpp,
    read_cpp_declarations,
    read_cpp_expression,
)
from aos_language.cpp.unset import unset_reads
from aos_language.document_code import absent_skills
from aos_language.findings import Findings
from aos_protocol.diagnostics import Mend, Severity, Span
from aos_protocol.documents import Assignment, Environment, SkillModel
from aos_protocol.spelling import nearest, quoted

__all__ = ["check_block", "check_environment_code", "check_skill_code", "read_block"]

_PLAIN_SPECIAL_NAMES = {name.strip("_").lower(): name for name in SPECIAL_NAMES}
_LITERAL_NAMES = frozenset({"false", "nullptr", "true"})
_TRUTHS = frozenset({"__isFailureState", "__isGoalState", "__meetPrecondition", "__stopEvaluatingState"})
_TEXT = re.compile(r'"(?:[^"\\]|\\.)*"')


def check_environment_code(environment: Environment, scope: Scope, findings: Findings) -> None:
    """All model code of the environment."""
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
    """All model code of a skill."""
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
    around = _Around(_temporary_enums(blocks), _declared_names(pieces))
    for piece in pieces:
        _BlockCheck(piece, scope, findings, around).run()


def check_block(block: Block, scope: Scope, findings: Findings) -> None:
    """A block that stands alone."""
    _BlockCheck(block, scope, findings, _Around({}, frozenset())).run()


def read_block(block: Block) -> Cpp:
    """A block's snippet, read."""
    if block.is_declarations:
        return read_cpp_declarations(block.snippet.code)
    return (read_cpp_expression if block.is_expression else read_cpp)(block.snippet.code)


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


class _Around(msgspec.Struct, frozen=True):
    """The declarations in the document's other code: enums with how many values they have, and all names."""

    enum_sizes: dict[str, int]
    declared: frozenset[str]


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
        self._reported_absent: set[str] = set()
        self._absent = self._absent_skills()
        self._locals = {declaration.name: declaration.type for declaration in self._cpp.declarations}

    def _absent_skills(self) -> frozenset[str]:
        """Skills that extrinsic code looks for, and that may have been left out."""
        if not self._block.role.sees_chosen_action:
            return frozenset()
        known = {*self._scope.skills, *self._block.names, *self._declared, *STATE_COPIES, *_LITERAL_NAMES}
        return absent_skills(self._cpp, known | {"NULL"})

    def run(self) -> None:
        for fault in self._cpp.faults:
            if fault.kind is FaultKind.SYNTAX:
                message, hint = f"{fault.message} in C++", "The compiler will tell more"
                self._findings.warning("AOS108", message, self._span(fault.extent), hint)
            else:
                span = self._span(fault.extent)
                mend = Mend(span, 1, fault.instead) if fault.instead else None
                self._findings.error("AOS108", fault.message, span, fault.hint, mend)
        if any(fault.kind is not FaultKind.SYNTAX for fault in self._cpp.faults):
            return
        self._check_semicolons()
        for mention in self._cpp.mentions:
            self._check_mention(mention)
        self._check_calls()
        self._check_lone_name()
        if self._block.is_declarations:
            for body in self._scope.shared.bodies():
                self._check_unset(read_cpp(body))
        elif not self._block.is_expression:
            self._check_idle_operators()
            self._check_unset(self._cpp)

    def _check_idle_operators(self) -> None:
        for operator in self._cpp.idle_operators:
            span = self._span(operator)
            if self._cpp.code[operator.start] == ",":
                hint = "A decimal is written with a point"
                message, mend = "the number behind this comma does nothing", Mend(span, 1, ".")
            else:
                hint = "To set what stands before it, write `=`"
                message, mend = "this comparison does nothing", Mend(span, 2, "=")
            self._findings.warning("AOS149", message, span, hint, mend)

    def _check_unset(self, cpp: Cpp) -> None:
        for read in unset_reads(cpp, frozenset(self._scope.enums)):
            report = self._findings.error if read.never else self._findings.warning
            which = "has no value" if read.never else "may have no value"
            hint = f"Declare it with one: `{read.type} {read.name} = ...;`"
            report("AOS143", f"`{read.name}` {which} here", self._span(read.extent), hint)

    def _check_semicolons(self) -> None:
        for offset in self._cpp.missing_semicolons:
            line = self._cpp.code.count("\n", 0, offset) + 1
            column = offset - (self._cpp.code.rfind("\n", 0, offset) + 1) + 1
            span = self._block.snippet.locate(line, column)
            mend = Mend(span, 0, ";")
            self._findings.warning("AOS127", "a semicolon is missing here", span, "It is put in", mend)

    def _check_calls(self) -> None:
        self._enum_sizes |= _enum_sizes(self._cpp)
        for call in self._cpp.calls:
            declared = self._declared.union(self._locals, self._block.names)
            check_built_in(call, self._cpp.code, declared, self._span, self._findings)
            if len(call.name) == 2 and call.name[1] in BUILT_INS.get(call.name[0], ()):
                self._check_enum(call)
                check_weights(call, self._cpp.code, self._enum_sizes, self._span, self._findings)

    def _check_enum(self, call: Call) -> None:
        """The first of two arguments of SampleDiscrete is an enum."""
        if call.name[1] != "SampleDiscrete" or len(call.arguments) != 2:
            return
        place = call.arguments[0]
        name = self._cpp.code[place.start : place.end].strip()
        declared = {declaration.name for declaration in self._cpp.declarations} | self._declared
        if name.isidentifier() and name not in self._enum_sizes and name not in declared:
            otherwise = _listing("The enums are", sorted(self._enum_sizes))
            self._unknown(name, self._enum_sizes, f"unknown enum `{name}`", self._span(place), otherwise)

    def _check_lone_name(self) -> None:
        """A default that is one name must be an enum's value, or low-level."""
        mentions = self._cpp.mentions
        if not self._block.is_expression or len(mentions) != 1 or len(mentions[0].path) != 1:
            return
        name = mentions[0].path[0]
        known = {*self._scope.enum_values, *self._scope.low_level_names, *self._block.names}
        known |= self._scope.shared.all_names
        if name == self._block.snippet.code.strip() and not name.startswith("_") and name not in known:
            if name in _LITERAL_NAMES or name.isupper():
                return
            self._unknown(name, known, f"unknown name `{name}`", self._span(mentions[0].root))

    # --- mentions --------------------------------------------------------------------------------------

    def _check_mention(self, mention: Mention) -> None:
        root = mention.path[0]
        if root in self._scope.shared.drawing and mention.access is not Access.CALL:
            self._check_drawing_function(mention, root)
        is_parameter = self._block.is_declarations and root in STATE_COPIES and root in self._locals
        if mention.access is Access.CALL or (root in self._locals and not is_parameter):
            return
        if is_parameter:
            # Of whatever copy it may be, a `state` in shared code is what a function is given.
            self._check_state_path(mention)
        elif self._block.is_declarations and root in STATE_COPIES:
            hint = f"Give the function a parameter, as `const auto& {root}`, or `auto& {root}` to change it"
            message = f"there is no `{root}` in shared code by itself"
            self._findings.error("AOS123", message, self._span(mention.root), hint)
        elif root in STATE_COPIES:
            self._check_copy(mention, root)
            self._check_state_path(mention)
        elif root in self._block.names:
            self._check_named_path(mention, root)
        elif self._block.role.sees_chosen_action and root in self._scope.skills and len(mention.path) > 1:
            self._check_action_path(mention, root)
        elif root in self._absent:
            self._check_absent_skill(mention, root)
        elif root not in self._declared:
            self._check_special_name(mention, root)

    def _check_drawing_function(self, mention: Mention, root: str) -> None:
        """The source of draws is given to a function where it is called, and only there."""
        names = {function.name_extent.start for function in self._scope.shared.functions}
        if root in self._locals or (self._block.is_declarations and mention.root.start in names):
            return
        message = f"`{root}` draws, so it can only be called"
        hint = f"Call it in a lambda: `[&](auto& each) {{ return {root}(each); }}`"
        self._findings.error("AOS145", message, self._span(mention.root), hint)

    def _check_absent_skill(self, mention: Mention, root: str) -> None:
        """A skill that is not there is never chosen; its parameters nobody knows."""
        span, skills = self._span(mention.root), self._scope.skills
        if len(mention.path) > 1:
            message = f"there is no skill `{root}` that has parameters"
            hint = "If it was left out, leave out what looks at its parameters too"
            self._unknown(root, skills, message, span, hint)
        elif root not in self._reported_absent:
            self._reported_absent.add(root)
            message, hint = f"there is no skill `{root}`", "It counts as one that is never chosen"
            self._findings.unknown(root, skills, message, span, hint, severity=Severity.WARNING)

    def _check_special_name(self, mention: Mention, root: str) -> None:
        """A name that starts as those of the language, or is set like one of them and lacks underscores."""
        known = (*SPECIAL_NAMES, *self._scope.low_level_names)
        is_set = mention.access in (Access.WRITE, Access.UPDATE)
        is_meant = is_set and root.strip("_").lower() in _PLAIN_SPECIAL_NAMES
        is_special = root.startswith("__") and not COMPILER_NAMES.fullmatch(root)
        if root in _TRUTHS:
            self._check_truth(mention)
        if root in known:
            return
        if is_meant:
            special = _PLAIN_SPECIAL_NAMES[root.strip("_").lower()]
            self._unknown(root, (special,), f"unknown name `{root}`", self._span(mention.root))
        elif is_special:
            self._unknown(root, known, f"unknown name `{root}`", self._span(mention.root))

    def _check_copy(self, mention: Mention, root: str) -> None:
        role = self._block.role
        is_write = mention.access in (Access.WRITE, Access.UPDATE)
        if self._scope.is_one_state_model and not (is_write and not role.writes):
            return
        span = self._span(mention.root)
        if root not in role.reads:
            hint = f"Only {quoted(role.reads)} can be read there"
            self._findings.error("AOS123", f"there is no `{root}` in {role.title}", span, hint)
        elif is_write and root not in role.writes:
            hint = f"Only {quoted(role.writes)} may change there" if role.writes else "It may only be read"
            if self._block.is_expression and mention.access is Access.WRITE:
                hint += ". To compare, write `==`"
            self._findings.error("AOS123", f"`{mention.text}` is written in {role.title}", span, hint)

    def _check_state_path(self, mention: Mention) -> None:
        if len(mention.path) == 1 or not self._scope.has_environment:
            return
        name = mention.path[1]
        found = self._scope.state_member(name)
        if found is None:
            known = self._scope.state_member_names()
            otherwise = _listing("The variables are", self._scope.variables)
            span = self._part_span(mention.extent, name)
            self._unknown(name, known, f"unknown state variable `{name}`", span, otherwise)
            return
        self._check_fields(mention, found, start=2)
        variable = self._scope.variables.get(name)
        is_write = mention.access in (Access.WRITE, Access.UPDATE)
        if variable is None or not variable.is_constant or not is_write:
            return
        if variable.is_mission_parameter and name != self._block.sets:
            hint = "A mission parameter is a constant of the mission: only its own default sets it"
            self._constant_written(mention, name, hint)
        elif not self._block.role.may_set_parameter_values:
            hint = "Values of action parameters are constants; set them where they are declared"
            self._constant_written(mention, name, hint)

    def _check_named_path(self, mention: Mention, root: str) -> None:
        if root in self._block.constants and mention.access in (Access.WRITE, Access.UPDATE):
            self._constant_written(mention, root, "A parameter is what the skill was called with")
        self._check_fields(mention, ValueType(self._block.names[root]), start=1)

    def _constant_written(self, mention: Mention, name: str, hint: str) -> None:
        message = f"{name} is written in {self._block.role.title}"
        self._findings.error("AOS128", message, self._span(mention.extent), hint)

    def _check_action_path(self, mention: Mention, root: str) -> None:
        parameters = {p.name: p.type for p in self._scope.skills[root].parameters}
        name = mention.path[1]
        if name in parameters:
            self._check_fields(mention, ValueType(parameters[name]), start=2)
            return
        span = self._part_span(mention.extent, name)
        self._unknown(name, parameters, f"the skill {root} has no parameter `{name}`", span)

    def _check_fields(self, mention: Mention, kind: ValueType, *, start: int) -> None:
        """Walks an access path through compound types; stops where a type is not of the documents."""
        name, is_container, index_enum = kind.name, kind.is_container, kind.index_enum
        subscripts = subscripts_of(mention, self._cpp.code)
        for part in mention.path[start:]:
            subscript = next(subscripts, None) if part == "[]" else None
            if part == "[]" and is_container:
                if index_enum in self._scope.enums and subscript is not None:
                    self._check_index(subscript, index_enum)
                is_container = False
                continue
            if is_container or part == "[]":
                return
            if name in NUMBERS or name in self._scope.enums:
                message = f"`{part}` of a {name}, which has no fields"
                self._findings.error("AOS110", message, self._part_span(mention.extent, part))
                return
            compound = self._scope.compounds.get(name)
            if compound is None:
                return
            fields = {field.name: field.type for field in compound.fields}
            if part not in fields:
                span = self._part_span(mention.extent, part)
                message = f"the type {name} has no field `{part}`"
                self._unknown(part, fields, message, span, _listing("It has", fields))
                return
            inner = ValueType.of(fields[part])
            name, is_container, index_enum = inner.name, inner.is_container, inner.index_enum
        if name == "bool" and not is_container:
            self._check_truth(mention)

    def _check_truth(self, mention: Mention) -> None:
        """A truth is given no text: the compiler takes each for true, `"false"` too."""
        given = mention.assigned
        if given is not None and _TEXT.fullmatch(self._cpp.code[given.start : given.end].strip()):
            message = f"`{mention.text}` is true or false, and this is a text"
            self._findings.error(
                "AOS106", message, self._span(given), "Write `true` or `false`, without quotes"
            )

    def _check_index(self, subscript: Extent, enum: str) -> None:
        """An array over an enum is indexed by its values, or by numbers."""
        name = self._cpp.code[subscript.start : subscript.end]
        values, owner = self._scope.enums[enum].values, self._scope.enum_values.get(name)
        if name in values or name in self._locals or name in self._declared or name in self._block.names:
            return
        if owner is not None:
            message = f"`{name}` is a {owner}, and this array is indexed by {enum}"
            hint = _listing(f"The values of {enum} are", values)
            self._findings.error("AOS110", message, self._span(subscript), hint)
        elif nearest(name, values):
            self._unknown(name, values, f"{enum} has no `{name}`", self._span(subscript))

    def _unknown(
        self, name: str, known: Iterable[str], message: str, span: Span, otherwise: str = ""
    ) -> None:
        self._findings.unknown(name, known, message, span, otherwise)

    # --- places ----------------------------------------------------------------------------------------

    def _span(self, extent: Extent) -> Span:
        return self._block.snippet.locate(extent.line, extent.column)

    def _part_span(self, extent: Extent, part: str) -> Span:
        """Returns the place of a name inside a path."""
        text = self._cpp.code[extent.start : extent.end]
        match = re.search(rf"(?<![\w]){re.escape(part)}(?!\w)", text)
        if match is None:
            return self._span(extent)
        before = text[: match.start()]
        line = extent.line + before.count("\n")
        column = match.start() - before.rfind("\n") if "\n" in before else extent.column + match.start()
        return self._block.snippet.locate(line, column)


def _listing(what: str, names: Iterable[str]) -> str:
    """The hint that gives all names there are; empty where there are none."""
    listed = quoted(names)
    return f"{what} {listed}" if listed else ""
