"""The copies of the state that a step makes.

Where no code reads an older copy of a variable after it has changed a newer one, the two are one object.
Where the text leaves a doubt, the copy is made: a copy costs time, and a missing copy would change the model.
"""

import re
from collections.abc import Iterable, Iterator

import msgspec

from aos_language.cpp.facts import READING_FUNCTIONS
from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.snippets import Access, Call, Cpp, DeclarationKind, Extent, Mention, strip_comments
from aos_language.document_code import shared_code_of, snippets_of
from aos_protocol.documents import Assignment, Environment, SkillModel
from aos_solver.emission.lowering.writes import LAMBDA, holding_maps, may_insert, may_refer, value_types

_WHOLE_STATE = "*"
_RESULTS = frozenset({"__reward", "__moduleResponse", "__moduleResponseStr"})
_READING_METHODS = frozenset({"at", "back", "contains", "count", "empty", "front", "length", "size"})
_GIVING_VALUES = READING_FUNCTIONS | {
    "accumulate", "all_of", "any_of", "binary_search", "count", "count_if", "distance", "equal", "none_of",
}  # fmt: skip
_REPEATED = re.compile(r"\b(?:for|while|do|goto)\b")
"""Words after which, as in lambdas, the order of the text is not that of the run."""


class Copies(msgspec.Struct, frozen=True):
    """The copies of `state` and `state_` that a step of a skill keeps apart from what comes after them."""

    keeps_state: bool
    keeps_state_: bool


class _Use(msgspec.Struct, frozen=True):
    """A mention of a state variable in the snippet of that number. What a write assigns is read before it; a
    handle may be read at any time."""

    variable: str
    snippet: int
    extent: Extent
    assigned: Extent | None = None
    is_handle: bool = False


class _Names(msgspec.Struct, frozen=True):
    """Shared functions that may give a handle to what they are given, functions that give plain values, the
    words of types of such values, and the variables that hold maps."""

    giving_handles: frozenset[str]
    giving_values: frozenset[str]
    types: frozenset[str]
    maps: frozenset[str]


class _Uses(msgspec.Struct, frozen=True):
    """All uses in a section. The text of `unordered` snippets is not in the order of the run."""

    reads: list[_Use]
    writes: list[_Use]
    unordered: frozenset[int]


def copies_of(model: SkillModel, environment: Environment) -> Copies:
    """Returns the copies that a step of this skill needs; models with one state have no copies."""
    dynamic = model.dynamic_model
    shared = shared_code_of(environment)
    giving = _GIVING_VALUES | shared.reading
    names = _Names(shared.changing, giving, value_types(environment), holding_maps(environment))
    extrinsic = environment.extrinsic_changes
    if all(cpp.is_empty for _, cpp in snippets_of(extrinsic)):
        return Copies(_reads_changed(dynamic, ("state", "state_"), "state__", names), keeps_state_=False)
    changed_before = {use.variable for use in _uses(extrinsic, ("state",), "state_", names).writes}
    read_after = {use.variable for use in _uses(dynamic, ("state",), "state__", names).reads}
    return Copies(
        keeps_state=_overlap(changed_before, read_after)
        or _reads_changed(extrinsic, ("state",), "state_", names)
        or _reads_changed(dynamic, ("state",), "state__", names),
        keeps_state_=_reads_changed(dynamic, ("state_",), "state__", names),
    )


def _reads_changed(
    section: tuple[Assignment, ...], older: tuple[str, ...], newer: str, names: _Names
) -> bool:
    """Returns whether the section may read an older copy of a variable after it has changed the newer one."""
    if any(assignment.over_previous or assignment.over_next for assignment in section):
        return True
    uses = _uses(section, older, newer, names)
    reads: dict[str, list[_Use]] = {}
    for read in uses.reads:
        reads.setdefault(read.variable, []).append(read)

    def reads_of(variable: str) -> Iterable[_Use]:
        if variable == _WHOLE_STATE:
            return uses.reads
        return (*reads.get(variable, ()), *reads.get(_WHOLE_STATE, ()))

    return any(
        not _is_before(read, write, uses.unordered)
        for write in uses.writes
        for read in reads_of(write.variable)
    )


def _is_before(read: _Use, write: _Use, unordered: frozenset[int]) -> bool:
    if read.is_handle or read.snippet > write.snippet:
        return False
    if read.snippet < write.snippet:
        return True
    if read.snippet in unordered:
        return False
    is_in_path = _covers(write.extent, read.extent)
    return read.extent.start < write.extent.start or is_in_path or _covers(write.assigned, read.extent)


def _uses(section: tuple[Assignment, ...], older: tuple[str, ...], newer: str, names: _Names) -> _Uses:
    reads, writes, unordered = [], [], set()
    for number, (_, cpp) in enumerate(snippets_of(section)):
        code = strip_comments(cpp.code)
        has_lambda = LAMBDA.search(code) is not None
        if has_lambda or _REPEATED.search(code):
            unordered.add(number)
        bound = [*_bound(cpp, names), *_given_to(names.giving_handles, cpp)]
        for mention in cpp.mentions:
            variable = _variable(mention)
            if mention.path[0] in older:
                is_bound = any(_covers(extent, mention.extent) for extent in bound)
                is_handle = has_lambda or is_bound or _makes_handle(mention)
                reads.append(_Use(variable, number, mention.extent, is_handle=is_handle))
            elif mention.path[0] == newer and (
                may_insert(mention, names.maps) or not _only_reads(mention, cpp, bound)
            ):
                writes.append(_Use(variable, number, mention.extent, mention.assigned))
    return _Uses(reads, writes, frozenset(unordered))


def _variable(mention: Mention) -> str:
    is_list = len(mention.path) > 1 and mention.path[1].endswith(("Objects", "ObjectsForActions"))
    return _WHOLE_STATE if len(mention.path) == 1 or is_list else mention.path[1]


def _makes_handle(mention: Mention) -> bool:
    """Returns whether the mention's value may be looked at later, when the variable has changed."""
    is_counted = mention.method in ("size", "empty")
    is_method = bool(mention.method) and mention.method not in _READING_METHODS
    is_object = _variable(mention) == _WHOLE_STATE and mention.path[2:] in ((), ("[]",)) and not is_counted
    return mention.access is not Access.READ or is_method or is_object


def _bound(cpp: Cpp, names: _Names) -> Iterator[Extent]:
    """Yields the expressions that references, pointers, iterators and views are made of."""
    types = names.types | {enum.name for enum in cpp.declarations if enum.kind is DeclarationKind.ENUM}
    for declaration in cpp.declarations:
        if declaration.initial is None:
            continue
        if may_refer(declaration.type, types):
            yield declaration.initial
        elif re.search(r"\bauto\b", declaration.type):
            yield from _views_in(cpp, declaration.initial, names)
    for mention in cpp.mentions:
        if mention.assigned is not None and len(mention.path) == 1 and mention.path[0] not in _RESULTS:
            yield from _views_in(cpp, mention.assigned, names)


def _views_in(cpp: Cpp, value: Extent, names: _Names) -> Iterator[Extent]:
    """Yields the parts of an expression that may still be looked at when it has been evaluated."""
    if "views" in cpp.text(value):
        yield value
    for call in cpp.calls:
        if _covers(value, call.extent) and not _gives_value(call, names):
            yield from call.arguments


def _gives_value(call: Call, names: _Names) -> bool:
    return bool(call.name) and (call.name[0] in DRAW_SOURCES or call.name[-1] in names.giving_values)


def _given_to(functions: frozenset[str], cpp: Cpp) -> Iterator[Extent]:
    """The arguments of calls of these functions."""
    for call in cpp.calls:
        if call.name[-1:] and call.name[-1] in functions:
            yield from call.arguments


def _only_reads(mention: Mention, cpp: Cpp, bound: Iterable[Extent]) -> bool:
    """Returns whether nothing can change through this mention of a copy that may be changed."""
    arguments = (argument for call in cpp.calls for argument in call.arguments)
    is_passed_on = any(_covers(extent, mention.extent) for extent in (*arguments, *bound))
    return mention.access is Access.READ and _variable(mention) != _WHOLE_STATE and not is_passed_on


def _covers(outer: Extent | None, inner: Extent) -> bool:
    return outer is not None and outer.start <= inner.start and inner.end <= outer.end


def _overlap(left: Iterable[str], right: Iterable[str]) -> bool:
    left, right = set(left), set(right)
    has_whole = _WHOLE_STATE in left | right
    return bool(left & right) or (has_whole and bool(left) and bool(right))
