"""The state variables that the code can change: the others are constants, and no particle holds them.

Where the text leaves a doubt, the variable counts as changed. A change that is missed all the same does not
compile: constants are constant to the compiler.
"""

import re
from collections.abc import Iterable, Iterator

from aos_language.cpp.facts import READING_FUNCTIONS
from aos_language.cpp.keywords import STATES
from aos_language.cpp.shared import SharedFunction
from aos_language.cpp.snippets import (
    Access,
    Cpp,
    DeclarationKind,
    Extent,
    Mention,
    read_cpp,
    read_cpp_expression,
)
from aos_language.document_code import shared_code_of, snippets_of
from aos_language.local_types import reported_variables
from aos_protocol.documents import Environment, Project
from aos_solver.emission.lowering.code import BELIEF, sections_of

LAMBDA = re.compile(r"\[\s*[&=]?[\w\s,&=]*\]\s*[({]")
"""The beginning of a lambda."""

_VALUES = frozenset({
    "array", "auto", "bool", "char", "const", "constexpr", "double", "float", "int", "int64_t", "long", "map",
    "optional", "pair", "set", "short", "signed", "size_t", "static", "std", "string", "tuple", "uint8_t",
    "unordered_map", "unordered_set", "unsigned", "vector",
})  # fmt: skip
"""The words in types of variables that refer to nothing else, whatever they start with."""
_GIVES_REFERENCE = re.compile(r"->\s*(?:decltype|[\w:<>, ]*&)")
_ONLY_READS = re.compile(r"const [\w:<>, ]+&$|const char\*$")
_CHANGING = (Access.WRITE, Access.UPDATE, Access.BIND)


def value_types(environment: Environment) -> frozenset[str]:
    """Returns the words in types of variables that refer to nothing, but for `&` and `*`."""
    return _VALUES | {each.name for each in environment.enums} | {each.name for each in environment.compounds}


def holding_maps(environment: Environment) -> frozenset[str]:
    """The variables with a map, also in a field."""
    words, types = re.compile(r"\w+"), {"map", "unordered_map"}
    for _ in environment.compounds:
        for each in environment.compounds:
            if any(not types.isdisjoint(words.findall(field.type)) for field in each.fields):
                types.add(each.name)
    return frozenset(
        variable.name
        for variable in environment.variables
        if variable.key_types or not types.isdisjoint(words.findall(variable.type))
    )


def may_insert(mention: Mention, maps: frozenset[str]) -> bool:
    """Returns whether this is an element by `[]` of what holds a map: where there is none, it is put in."""
    return not maps.isdisjoint(mention.path[1:2]) and "[]" in mention.path


def may_refer(type_text: str, values: frozenset[str]) -> bool:
    """Returns whether a variable of the type may refer to what it starts from."""
    words = re.findall(r"[A-Za-z_]\w*", type_text)
    return not values.issuperset(words) or not {"&", "*"}.isdisjoint(type_text)


class Changes:
    """The changes: `variables` by name, and every variable of the types that are walked as objects."""

    def __init__(self, project: Project) -> None:
        environment = project.environment
        self._names = frozenset(variable.name for variable in environment.variables)
        self.variables: set[str] = set()
        self.object_types: set[str] = set()
        self.value_types: set[str] = set()
        self._compounds = frozenset(compound.name for compound in environment.compounds)
        self._values = value_types(environment)
        self._maps = holding_maps(environment)
        self._shared = shared_code_of(environment)
        self._inside = list(_passed_to_functions(self._shared.cpp, self._shared.reading))
        for mention in self._shared.cpp.mentions:
            if len(mention.path) > 1:
                self._read_list(mention.path[1])

    def read(self, cpp: Cpp, copies: frozenset[str]) -> None:
        """Takes in a snippet that may change these copies of the state."""
        passed_on = [*_passed_to_functions(cpp, self._shared.reading), *_referred_to(cpp, self._values)]
        changed_by_lambda = _changed_by_lambdas(cpp, passed_on) | self._changed_by_shared_code(cpp)
        whole_copies = _whole_copies(cpp)
        for mention in cpp.mentions:
            if mention.path[0] in whole_copies and mention.access in _CHANGING:
                self._change(mention)
            if mention.path[0] not in STATES:
                continue
            if mention.extent.start in changed_by_lambda and mention.path[0] in copies:
                self.variables |= self._names & changed_by_lambda[mention.extent.start]
                continue
            if len(mention.path) > 1:
                self._read_list(mention.path[1])
                if mention.path[0] in copies and may_insert(mention, self._maps):
                    self._change(mention)
            if mention.path[0] in copies and (mention.access in _CHANGING or _is_in(mention, passed_on)):
                self._change(mention)
            elif mention.path[0] in copies and len(mention.path) == 1:
                self.variables |= self._names

    def walk(self, type_name: str) -> None:
        """The variables of this type are walked over."""
        if type_name in self._compounds:
            self.object_types.add(type_name)

    def _changed_by_shared_code(self, cpp: Cpp) -> dict[int, set[str]]:
        """The members that a shared function changes, for each place where it is given the whole state."""
        found: dict[int, set[str]] = {}
        own = cpp.declared
        for call in cpp.calls:
            functions = [function for function in self._shared.functions if call.name == (function.name,)]
            for index, argument in enumerate(call.arguments if own.isdisjoint(call.name) else ()):
                changed = [self._changed_in(function, index) for function in functions]
                if changed and None not in changed:
                    found[argument.start] = set().union(*(names or () for names in changed))
        whole = {mention.extent.start for mention in cpp.mentions if len(mention.path) == 1}
        return {start: names for start, names in found.items() if start in whole}

    def _changed_in(self, function: SharedFunction, index: int) -> set[str] | None:
        """Returns what the function changes of a parameter; None where that cannot be told."""
        if function.only_reads:
            return set()
        parameter = function.takes[index] if index < len(function.takes) else ""
        return (
            _changed_members(self._shared.cpp, function.extent, parameter, self._inside)
            if parameter and not function.gives_handle
            else None
        )

    def _read_list(self, name: str) -> None:
        self.walk(name.removesuffix("Objects"))
        if name.endswith("ObjectsForActions"):
            self.value_types.add(name.removesuffix("ObjectsForActions"))

    def _change(self, mention: Mention) -> None:
        if len(mention.path) == 1:
            self.variables |= self._names
        elif mention.path[1] in self._names:
            self.variables.add(mention.path[1])


def _whole_copies(cpp: Cpp) -> frozenset[str]:
    """The variables of the code that start as a copy of a whole state, `auto then = state;`."""
    whole = {(m.extent.start, m.extent.end) for m in cpp.mentions if len(m.path) == 1 and m.path[0] in STATES}
    starts = ((declaration, declaration.initial) for declaration in cpp.declarations)
    return frozenset(
        declaration.name
        for declaration, initial in starts
        if initial is not None and (initial.start, initial.end) in whole
    )


def changes_of(project: Project, *, after_start: bool = False) -> Changes:
    """Everything that the code of the documents can change while a particle lives.

    With `after_start` what the defaults and the initial belief set counts for nothing.
    """
    changes = Changes(project)
    environment = project.environment
    for skill in project.skills:
        changes.variables.update(reported_variables(skill.mapping, environment))
    for phase, assignments in sections_of(project):
        if after_start and phase is BELIEF:
            continue
        copies = phase.changes
        if environment.is_one_state_model and phase.changes:
            copies = frozenset(STATES)
        for assignment in assignments:
            for loop in (*assignment.over_previous, *assignment.over_next):
                changes.walk(loop.type)
        for _, cpp in snippets_of(assignments):
            changes.read(cpp, copies)
    for special in environment.special_states:
        if special.condition is not None:
            changes.read(read_cpp_expression(special.condition.code), frozenset())
    for constraint in project.constraints:
        changes.read(read_cpp_expression(constraint.never.code), frozenset())
    if after_start:
        return changes
    drawn = frozenset(drawing_defaults(environment))
    is_drawn = False
    for variable in environment.variables:
        is_drawn = is_drawn or variable.name in drawn
        if variable.default_code is not None:
            copies = frozenset({"state"}) if is_drawn else frozenset()
            changes.read(read_cpp(variable.default_code.code), copies)
        if variable.default_value is not None and is_drawn:
            changes.variables.add(variable.name)
    return changes


def drawing_defaults(environment: Environment) -> Iterator[str]:
    """The variables whose default is drawn at random."""
    sources = {"AOS", "AOSUtils"} | shared_code_of(environment).drawing
    for variable in environment.variables:
        for snippet in (variable.default_code, variable.default_value):
            if snippet is None:
                continue
            mentions = read_cpp(snippet.code).mentions or read_cpp_expression(snippet.code).mentions
            if any(mention.path[0] in sources for mention in mentions):
                yield variable.name


def _referred_to(cpp: Cpp, values: frozenset[str]) -> Iterator[range]:
    """Yields what variables may refer to, and the lambdas that give references."""
    enums = (each.name for each in cpp.declarations if each.kind is DeclarationKind.ENUM)
    types = values.union(enums)
    names = set()
    for declaration in cpp.declarations:
        code = cpp.text(declaration.initial) if declaration.initial else ""
        is_lambda = code.startswith("[") and _GIVES_REFERENCE.search(code) is not None
        if not _ONLY_READS.match(declaration.type) and (may_refer(declaration.type, types) or is_lambda):
            names.add(declaration.name)
            yield from _ranges([declaration.initial])
    for mention in cpp.mentions:
        yield from _ranges([mention.assigned] if mention.path[0] in names else [])
    for call in cpp.calls:
        yield from _ranges(call.arguments if names.intersection(call.name[:1]) else ())


def _ranges(extents: Iterable[Extent | None]) -> Iterator[range]:
    return (range(extent.start, extent.end) for extent in extents if extent is not None)


def _passed_to_functions(cpp: Cpp, reading: frozenset[str]) -> Iterator[range]:
    """The arguments of calls to functions that may take them by reference; `reading` are some that do not."""
    own = cpp.declared
    for call in cpp.calls:
        is_function = len(call.name) == 1 or call.name[:1] == ("std",)
        if is_function and call.name[-1] not in READING_FUNCTIONS | (reading - own):
            yield from _ranges(call.arguments)


def _changed_by_lambdas(cpp: Cpp, passed_on: list[range]) -> dict[int, set[str]]:
    """The members that a lambda of the code changes, for each place where it is given the whole state."""
    lambdas = {
        declaration.name: declaration.initial
        for declaration in cpp.declarations
        if declaration.initial is not None
        and cpp.code[declaration.initial.start] == "["
        and not _GIVES_REFERENCE.search(cpp.code, declaration.initial.start, declaration.initial.end)
    }
    found = {}
    for call in cpp.calls:
        body = lambdas.get(call.name[0]) if len(call.name) == 1 else None
        parameters = [] if body is None else _parameters(cpp, body)
        for argument, parameter in zip(call.arguments, parameters, strict=False):
            changed = _changed_members(cpp, body, parameter, passed_on)
            if changed is not None:
                found[argument.start] = changed
    return {
        mention.extent.start: found[mention.extent.start]
        for mention in cpp.mentions
        if len(mention.path) == 1 and mention.extent.start in found
    }


def _parameters(cpp: Cpp, body: Extent) -> list[str]:
    """The names of a lambda's parameters; none where another lambda within has parameters, too."""
    text = cpp.text(body)
    if len(LAMBDA.findall(text)) != 1:
        return []
    return [
        declaration.name
        for declaration in cpp.declarations
        if declaration.kind is DeclarationKind.PARAMETER
        and declaration.extent.start in range(body.start, body.end)
    ]


def _changed_members(
    cpp: Cpp, body: Extent | None, parameter: str, passed_on: list[range]
) -> set[str] | None:
    """The members of the parameter that the lambda changes; None where it uses the parameter as a whole."""
    if body is None:
        return None
    names = {declaration.extent.start for declaration in cpp.declarations}
    uses = [
        mention
        for mention in cpp.mentions
        if mention.path[0] == parameter
        and mention.extent.start in range(body.start, body.end)
        and mention.extent.start not in names
    ]
    if any(len(mention.path) == 1 for mention in uses):
        return None
    return {m.path[1] for m in uses if m.access in _CHANGING or _is_in(m, passed_on)}


def _is_in(mention: Mention, ranges: list[range]) -> bool:
    return any(mention.extent.start in extent for extent in ranges)
