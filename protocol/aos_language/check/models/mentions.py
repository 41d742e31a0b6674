"""Names in the C++ of environment and skills: is each one there, and may it be read or written there?"""

import re
from collections.abc import Iterable, Iterator, Set

from aos_language.check.models.blocks import Block, titles_with
from aos_language.check.scope import NUMBERS, Scope, ValueType
from aos_language.cpp.keywords import COMPILER_NAMES, SPECIAL_NAMES, STATES
from aos_language.cpp.pointers import bound_paths, changes_bound, without_null
from aos_language.cpp.snippets import Access, Cpp, Extent, Mention
from aos_language.document_code import absent_skills
from aos_language.findings import Findings
from aos_protocol.diagnostics import Mend, Severity, Span
from aos_protocol.spelling import nearest, quoted

_LONE_NAME = re.compile(r"\s*([A-Za-z_]\w*)\s*")
_PLAIN_SPECIAL_NAMES = {name.strip("_").lower(): name for name in SPECIAL_NAMES}
_PLAIN_SPECIAL_NAMES |= dict.fromkeys(("response", "observation"), "__moduleResponse")
_PLAIN_SPECIAL_NAMES |= {"failure": "__isFailureState", "goal": "__isGoalState"}
LITERAL_NAMES = frozenset({"false", "nullptr", "true"})
_TRUTHS = frozenset({"__isFailureState", "__isGoalState", "__meetPrecondition", "__stopEvaluatingState"})
_TEXT = re.compile(r'"(?:[^"\\]|\\.)*"')
_OWN_TYPE = re.compile(r"\b(?:class|struct|union)\b")
"""Code with a type of its own may set that one's fields by their names."""


_ORDERING = frozenset({
    "iter_swap", "nth_element", "partial_sort", "partition", "random_shuffle", "remove", "remove_if",
    "reverse", "rotate", "shuffle", "sort", "stable_partition", "stable_sort", "swap", "unique",
})  # fmt: skip


class MentionCheck:
    """The names of one snippet; `declared` are those that code around it declares."""

    def __init__(self, block: Block, cpp: Cpp, scope: Scope, declared: Set[str], findings: Findings) -> None:
        self._block = block
        self._cpp = cpp
        self._scope = scope
        self._declared = declared
        self._findings = findings
        self._locals = cpp.declared
        self._absent = self._absent_skills()
        self._always_run = without_null(cpp.code, self._absent)
        self._reported_absent: set[str] = set()
        self._bound = bound_paths(cpp)

    def _absent_skills(self) -> frozenset[str]:
        """Skills that extrinsic code looks for, and that may have been left out."""
        if not self._block.role.sees_chosen_action or self._scope.has_unread_files:
            return frozenset()
        known = {*self._scope.skills, *self._block.names, *self._declared, *STATES, *LITERAL_NAMES}
        return absent_skills(self._cpp, known | {"NULL"})

    def check(self, mention: Mention) -> None:
        """The name that begins the path, and each part of it."""
        root = mention.path[0]
        if root in self._scope.shared.drawing and mention.access is not Access.CALL:
            self._check_drawing_function(mention, root)
        if root in self._bound and changes_bound(self._cpp, mention):
            self._check_bound(mention, self._bound[root])
        is_parameter = self._block.is_declarations and root in STATES and root in self._locals
        if mention.access is Access.CALL or (root in self._locals and not is_parameter):
            return
        if is_parameter:
            # Of whatever copy it may be, a `state` in shared code is what a function is given.
            self._check_state_path(mention)
        elif self._block.is_declarations and root in STATES:
            hint = f"Give the function a parameter, as `const auto& {root}`, or `auto& {root}` to change it"
            message = f"there is no `{root}` in shared code by itself"
            self._findings.error("AOS123", message, self._span(mention.root), hint)
        elif root in STATES:
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
        """A skill that is not there is never chosen. Its parameters nobody knows, and code that would read
        them whatever was chosen is an error."""
        span, skills, place = self._span(mention.root), self._scope.skills, mention.root
        runs = self._always_run[place.start : place.end] == root
        if runs and len(mention.path) > 1:
            message = (
                f"a parameter of `{root}` is read where it may not be chosen, and there is no such skill"
            )
            hint = f"Read it where `{root} != NULL` holds: `if ({root} != NULL) ...`"
            self._findings.unknown(root, skills, message, span, hint)
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
        if root in SPECIAL_NAMES and root not in ("__observed", *self._block.role.names):
            message = f"there is no `{root}` in {self._block.role.title}"
            *first, last = titles_with(root)
            hint = f"Only {', '.join(first)}{' and ' * bool(first)}{last} can use it"
            self._findings.error("AOS110", message, self._span(mention.root), hint)
            return
        if root in _TRUTHS:
            self._check_truth(mention)
        if root in known:
            return
        if is_meant:
            special = _PLAIN_SPECIAL_NAMES[root.strip("_").lower()]
            mend = Mend(span := self._span(mention.root), len(root), special)
            self._findings.error("AOS110", f"unknown name `{root}`", span, f"Did you mean `{special}`?", mend)
        elif is_special:
            self._findings.unknown(root, known, f"unknown name `{root}`", self._span(mention.root))
        elif is_set and root in self._scope.variables and not _OWN_TYPE.search(self._cpp.code):
            # Nothing else of the documents has this name.
            right = f"{(self._block.role.writes or self._block.role.reads)[0]}.{root}"
            mend = Mend(span := self._span(mention.root), len(root), right)
            self._findings.error("AOS110", f"unknown name `{root}`", span, f"Did you mean `{right}`?", mend)

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
            is_condition = any(left == mention.extent for left, _ in self._cpp.set_in_conditions)
            if is_condition or (self._block.is_expression and mention.access is Access.WRITE):
                hint += ". To compare, write `==`"
            self._findings.error("AOS123", f"`{mention.text}` is written in {role.title}", span, hint)

    def _check_bound(self, mention: Mention, path: tuple[str, ...]) -> None:
        """A reference or a pointer changes what it stands for."""
        role, root = self._block.role, mention.path[0]
        if path[0] in role.writes or path[0] not in role.reads or self._scope.is_one_state_model:
            return
        message = f"`{root}` is a part of `{path[0]}`, which may only be read in {role.title}"
        hint = f"Only {quoted(role.writes)} may change there" if role.writes else ""
        self._findings.error("AOS123", message, self._span(mention.root), hint)

    def _check_state_path(self, mention: Mention) -> None:
        if len(mention.path) == 1 or not self._scope.has_environment:
            return
        name = mention.path[1]
        found = self._scope.state_member(name)
        if found is None:
            known = self._scope.state_member_names()
            otherwise = listing("The variables are", self._scope.variables)
            span = self._part_span(mention.extent, name)
            self._findings.unknown(name, known, f"unknown state variable `{name}`", span, otherwise)
            return
        if name not in self._scope.variables and self._reorders(mention):
            hint = f"Change a copy of it: `auto list = {mention.path[0]}.{name};`"
            message = f"the list `{name}` keeps its objects in their order"
            self._findings.error("AOS128", message, self._part_span(mention.extent, name), hint)
        if self._scope.lacks_objects(name.removesuffix("Objects")):
            span = self._part_span(mention.extent, name)
            check_objects(name.removesuffix("Objects"), f"`{name}` is empty", span, self._findings)
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

    def _reorders(self, mention: Mention) -> bool:
        """Returns whether a list of objects would be changed itself, once for each statement."""
        given = ((call.name[-1:], place.start) for call in self._cpp.calls for place in call.arguments[:1])
        names = {name for parts, start in given if start == mention.extent.start for name in parts}
        is_written = mention.access in (Access.WRITE, Access.UPDATE)
        return mention.path[2:] in ((), ("[]",)) and (is_written or not _ORDERING.isdisjoint(names))

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
        self._findings.unknown(name, parameters, f"the skill {root} has no parameter `{name}`", span)

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
                self._findings.unknown(part, fields, message, span, listing("It has", fields))
                return
            inner = ValueType.of(fields[part])
            name, is_container, index_enum = inner.name, inner.is_container, inner.index_enum
        if name == "bool" and not is_container:
            self._check_truth(mention)

    def _check_truth(self, mention: Mention) -> None:
        """A truth is given no text: the compiler takes each for true, `"false"` too."""
        given = mention.assigned
        if given is not None and _TEXT.fullmatch(self._cpp.text(given).strip()):
            message = f"`{mention.text}` is true or false, and this is a text"
            self._findings.error(
                "AOS106", message, self._span(given), "Write `true` or `false`, without quotes"
            )

    def _check_index(self, subscript: Extent, enum: str) -> None:
        """An array over an enum is indexed by its values, or by numbers."""
        name = self._cpp.text(subscript)
        values, owner = self._scope.enums[enum].values, self._scope.enum_values.get(name)
        if name in values or name in self._locals or name in self._declared or name in self._block.names:
            return
        if owner is not None:
            message = f"`{name}` is a {owner}, and this array is indexed by {enum}"
            hint = listing(f"The values of {enum} are", values)
            self._findings.error("AOS110", message, self._span(subscript), hint)
        elif nearest(name, values):
            self._findings.unknown(name, values, f"{enum} has no `{name}`", self._span(subscript))

    def _span(self, extent: Extent) -> Span:
        return self._block.snippet.at(extent.start)

    def _part_span(self, extent: Extent, part: str) -> Span:
        """Returns the place of a name inside a path."""
        text = self._cpp.text(extent)
        match = re.search(rf"(?<![\w]){re.escape(part)}(?!\w)", text)
        return self._block.snippet.at(extent.start + (match.start() if match is not None else 0))


def check_objects(compound: str, what: str, span: Span, findings: Findings) -> None:
    """Tells once of a list or a loop over a type that has no objects."""
    message = f"{what}: no state variable is a {compound}"
    if all(message != told.message for told in findings.diagnostics):
        hint = "Action parameters and elements of arrays are not among them"
        findings.warning("AOS133", message, span, hint)


def listing(what: str, names: Iterable[str]) -> str:
    """The hint that gives all names there are; empty where there are none."""
    listed = quoted(names)
    return f"{what} {listed}" if listed else ""


def subscripts_of(mention: Mention, code: str) -> Iterator[Extent | None]:
    """Yields for each `[...]` of the path, in order, the place of its one name; None where it is no lone
    name."""
    depth = 0
    start = mention.extent.start
    for at in range(mention.extent.start, mention.extent.end):
        if code[at] == "[":
            depth += 1
            start = at + 1 if depth == 1 else start
        elif code[at] == "]":
            depth -= 1
            if depth == 0:
                match = _LONE_NAME.fullmatch(code, start, at)
                yield Extent(*match.span(1)) if match is not None else None
