"""Edits for what documents do with containers of the standard library.

State variables are not std::vector, std::string and std::map, though they convert to these. A table that a
block of code fills with constants anew in each run costs more than the rest of the step.
"""

import re
from collections.abc import Iterator

from aos_language.cpp.keywords import DRAW_SOURCES, STATES
from aos_language.cpp.pointers import path_bound
from aos_language.cpp.snippets import (
    Access,
    Call,
    Cpp,
    Declaration,
    DeclarationKind,
    Mention,
    blanked,
    strip_comments,
)
from aos_solver.emission.rewriting.references import end_of_body

_CONTAINER_REFERENCE = re.compile(
    r"((?:std\s*::\s*)?(?:vector|map|set|pair)\s*<[^\n;(){}]*>|(?:std::)?string)\s*&\s*$"
)
_CONTAINER_POINTER = re.compile(_CONTAINER_REFERENCE.pattern.replace("&", r"\*"))
_FUNCTION_OF_REFERENCE = re.compile(
    r"((?:std\s*::\s*)?function\s*<.*(?:vector|map|string)\b[^;]*&[^;]*>)\s*$"
)
_HELD = re.compile(
    r"(->\s*(?:const\s+)?)?\b((?:std\s*::\s*)?(?:(?:vector|map|set|pair)\s*<(?:[^<>;(){}]|<[^<>]*>)*>|string))\s*([*&])"
)
_NO_ADDRESS = re.compile(r"\s*(?:nullptr|NULL|0)\s*|\s*\{.*", re.DOTALL)
_STD = re.compile(r"std\s*::\s*")
_OF_STATE = frozenset({"erase", "erase_if", "getline", "swap"})
_ITERATOR = re.compile(
    r"((?:std\s*::\s*)?(?:vector|map|set|string)\b[^\n;(){}]*::\s*(?:const_)?(?:reverse_)?iterator)\s+$"
)
_BIT = re.compile(r"((?:std\s*::\s*)?vector\s*<\s*bool\s*>\s*::\s*reference)\s+$")
_VECTOR = re.compile(r"(?:^|[;{}])\s*((const\s+)?(?:std\s*::\s*)?vector\s*<[^;(){}]*>\s*)$")
_WEIGHTS = re.compile(r"\s*(?:std\s*::\s*)?vector\s*<\s*double\s*>\s*(?=\{)")
_READING_METHODS = frozenset({"at", "back", "cbegin", "cend", "empty", "front", "size"})
_MAP_VIEW = re.compile(r"\b(?:std\s*::\s*)?(?:ranges\s*::\s*)?views\s*::\s*(keys|values)\b")
_FLIPPED = re.compile(r"(?<=\])\s*\.\s*flip\s*\(\s*\)\Z")
_LITERAL = re.compile(r"[-+\s{},]|\d[\w.]*|\.\d\w*")
_WORD = re.compile(r"[A-Za-z_]\w*")
_LAMBDA_BEFORE = re.compile(r"(\w+)\s*=\s*\[[^\][]*\]\s*\(([^()]*)$")
_LOOPS_OVER = re.compile(r"\s*:(?!:)\s*")


def container_edits(cpp: Cpp, values: frozenset[str]) -> Iterator[tuple[int, int, str]]:
    """Replacements (start, end, text) by offsets; `values` are the names of constants.

    - `vector<int>::iterator at = state__.row.begin();` becomes `auto at`, also from `auto& row = state__.row`
    - `vector<bool>::reference bit = state__.bits[1];` becomes `auto&& bit`
    - `vector<int>& row = state__.row;` and a lambda's `vector<int>& row` become `auto& row`, and so does a
      `const` one of a row that the code changes, or of a lambda in code that changes the state
    - `vector<int>* row = &state__.row;` becomes `auto* row`
    - other pointers, `vector<int>* rows[] = {&state__.row}`, become those of `aos::Held`; a lambda's
      `-> vector<int>&` becomes `-> auto&`
    - `std::function<void(vector<int>&)> grow = [](...) {...}` becomes `auto grow`
    - `mine.swap(state__.row)` becomes `swap(mine, state__.row)`
    - `state__.bits[1].flip()` becomes `aos::flip(state__.bits[1])`
    - `std::swap`, `std::erase`, `std::erase_if`, `std::getline` lose their `std::`: a state's are not there
    - `std::views::keys` becomes `aos::keys`, which also takes a map of the state
    - a vector of constants that is only read becomes `static const`
    - `AOS.SampleDiscrete(vector<double>{0.5, 0.5})` becomes `AOS.SampleDiscrete({0.5, 0.5})`
    """
    own = cpp.declared
    for view in _MAP_VIEW.finditer(blanked(strip_comments(cpp.code), cpp.literals)):
        yield *view.span(), f"aos::{view[1]}"
    for call in cpp.calls:
        if _is_draw(call):
            weights = _WEIGHTS.match(cpp.code, call.arguments[-1].start)
            if weights is not None and _is_constant(cpp.code[weights.end() : call.arguments[-1].end], values):
                yield weights.start(), weights.end(), ""
        prefix = _STD.match(cpp.code, call.extent.start)
        if prefix is not None and {*call.name[-1:]} & _OF_STATE - own:
            yield prefix.start(), prefix.end(), ""
        if (flipped := _FLIPPED.search(cpp.code, call.extent.start, call.extent.end)) is not None:
            yield call.extent.start, call.extent.start, "aos::flip("
            yield flipped.start(), call.extent.end, ")"
        if call.name[1:] == ("swap",) and call.name[0] in own and call.arguments:
            yield call.extent.start, call.extent.start, "swap("
            yield call.extent.start + len(call.name[0]), call.arguments[0].start, ", "
    for declaration in cpp.declarations:
        before = cpp.code[: declaration.extent.start]
        if declaration.type.endswith("reference") and (bit := _BIT.search(before)) is not None:
            yield bit.start(1), bit.end(1), "auto&&"
        elif declaration.type.endswith("iterator") and _leads_to_state(cpp, declaration):
            if (iterator := _ITERATOR.search(before)) is not None:
                yield iterator.start(1), iterator.end(1), "auto"
        elif declaration.type.endswith("&"):
            reference = _CONTAINER_REFERENCE.search(before)
            is_const = declaration.type.startswith("const")
            may_bind = _sees_changes if is_const else _may_bind_state
            if reference is not None and may_bind(cpp, declaration, before):
                yield reference.start(1), reference.end(1), "auto"
        elif declaration.type.endswith("*"):
            pointer = _CONTAINER_POINTER.search(before)
            if pointer is not None and _starts_with_one(cpp, declaration):
                yield pointer.start(1), pointer.end(1), "auto"
        elif declaration.kind is DeclarationKind.VARIABLE and declaration.initial is not None:
            vector = _VECTOR.search(before)
            function = _FUNCTION_OF_REFERENCE.search(before)
            if function is not None and _is_plain_lambda(cpp, declaration):
                yield function.start(1), function.end(1), "auto"
            if vector is not None and _is_constant_table(cpp, declaration, values, is_const=bool(vector[2])):
                yield vector.start(1), vector.start(1), "static " if vector[2] else "static const "
    yield from _held_edits(cpp)


def _held_edits(cpp: Cpp) -> Iterator[tuple[int, int, str]]:
    """Edits of pointers whose type is not that of what they start with, and of what lambdas return."""
    of_state = [mention for mention in cpp.mentions if mention.path[0] in STATES]
    bound = {m.extent.start: place for m in cpp.mentions if (place := _place_bound(cpp, m))}
    code = blanked(strip_comments(cpp.code), cpp.literals)
    for held in _HELD.finditer(code) if of_state else ():
        if held[1]:
            yield *held.span(2), "auto"
            continue
        declared = next((each for each in cpp.declarations if each.extent.start >= held.end()), None)
        if held[3] == "&" or declared is None or not bound:
            continue
        if _starts_with_one(cpp, declared) and not code[held.end() : declared.extent.start].strip():
            continue
        starts = sorted(bound, key=lambda start: start < held.start())
        types = "".join(f", decltype(({place}))" for place in dict.fromkeys(bound[at] for at in starts))
        yield *held.span(2), f"aos::Held<{held[2]}{types}>"


def _place_bound(cpp: Cpp, mention: Mention) -> str:
    """Returns the part of the state that code may point to by a mention, also by the object of a loop."""
    if mention.access is not Access.BIND:
        return ""
    path = mention.path
    if path[0] not in STATES:
        own = next((one for one in cpp.declarations if one.name == path[0]), None)
        objects = path_bound(cpp, own) if own is not None and own.initial is None else ()
        path = (*objects, "[]", *path[1:]) if objects else ()
    place = ".".join(path).replace(".[]", "[{}]").replace("Objects[{}].", "Objects()[0]->")
    return "" if place.endswith(("Objects", "Objects[{}]")) else place


def _may_bind_state(cpp: Cpp, declaration: Declaration, before: str) -> bool:
    if declaration.kind is DeclarationKind.PARAMETER:
        return re.search(r"\]\s*\([^()]*$", before) is not None
    initial = declaration.initial
    own = {each.name for each in cpp.declarations if not each.type.endswith(("&", "*", "auto"))}
    return initial is not None and cpp.text(initial) not in own


def _sees_changes(cpp: Cpp, declaration: Declaration, before: str) -> bool:
    """Returns whether a const reference is bound to a part of the state that the same code changes."""
    changed = [mention.path for mention in cpp.mentions if mention.access is not Access.READ]
    if declaration.kind is not DeclarationKind.PARAMETER:
        path = path_bound(cpp, declaration)[:2]
        return bool(path) and any(each[:2] == path for each in changed)
    roots = {each.name for each in cpp.declarations if each.type.endswith(("&", "*"))}.union(STATES)
    is_changed = any(path[0] in roots for path in changed)
    return is_changed and _is_given_paths(cpp, declaration, before) and not _is_copied(cpp, declaration)


def _is_given_paths(cpp: Cpp, parameter: Declaration, before: str) -> bool:
    """Returns whether a lambda is only called, and each call gives a path to this parameter, not `{1, 2}`."""
    own = _LAMBDA_BEFORE.search(before)
    if own is None:
        return False
    index = sum(
        each.kind is DeclarationKind.PARAMETER and own.start(2) <= each.extent.start < parameter.extent.start
        for each in cpp.declarations
    )
    calls = [call for call in cpp.calls if call.name == (own[1],) and len(call.arguments) > index]
    uses = [m for m in cpp.mentions if m.path[0] == own[1] and m.extent.start != own.start(1)]
    paths = {mention.extent for mention in cpp.mentions if not mention.method}
    return len(calls) == len(uses) and all(call.arguments[index] in paths for call in calls)


def _is_copied(cpp: Cpp, parameter: Declaration) -> bool:
    """Returns whether a lambda uses a parameter as a whole other than in loops, methods and calls.

    A copy of a state's vector, as by `auto copy = row`, cannot grow beyond that one's capacity.
    """
    end = end_of_body(cpp.code, parameter.extent.end)
    given = {argument for call in cpp.calls for argument in call.arguments}
    return any(
        mention.path == (parameter.name,)
        and parameter.extent.end <= mention.extent.start < end
        and not mention.method
        and mention.extent not in given
        and not cpp.code[: mention.extent.start].rstrip().endswith(":")
        for mention in cpp.mentions
    )


def _is_plain_lambda(cpp: Cpp, declaration: Declaration) -> bool:
    """Returns whether a variable is a lambda for good, and one that does not call itself."""
    initial = declaration.initial
    assert initial is not None
    uses = [mention for mention in cpp.mentions if mention.path[0] == declaration.name]
    reads = (Access.CALL, Access.READ)
    is_called = all(use.access in reads and use.extent.start > initial.end for use in uses)
    return is_called and cpp.code.startswith("[", initial.start)


def _starts_with_one(cpp: Cpp, declaration: Declaration) -> bool:
    """Returns whether a variable, which is no array, starts with a pointer that leads somewhere."""
    initial = declaration.initial
    if initial is None or _NO_ADDRESS.fullmatch(cpp.code, initial.start, initial.end):
        return False
    return (
        cpp.code[initial.end :].lstrip()[:1] != "," and cpp.code[declaration.extent.end :].lstrip()[:1] != "["
    )


def _holds(declaration: Declaration, places: set[int]) -> bool:
    initial = declaration.initial
    return initial is not None and any(initial.start <= at < initial.end for at in places)


def _leads_to_state(cpp: Cpp, declaration: Declaration) -> bool:
    """Returns whether a variable starts with the state, or with a reference or a pointer into it."""
    places = _places_of_state(cpp)
    for earlier in cpp.declarations:
        if earlier is declaration:
            break
        loops_over = _LOOPS_OVER.match(cpp.code, earlier.extent.end)
        is_inside = _holds(earlier, places) or (loops_over is not None and loops_over.end() in places)
        if earlier.type.endswith(("&", "*")) and is_inside:
            places |= {
                mention.extent.start
                for mention in cpp.mentions
                if mention.path[0] == earlier.name and mention.extent.start > earlier.extent.start
            }
    return _holds(declaration, places)


def _places_of_state(cpp: Cpp) -> set[int]:
    return {mention.extent.start for mention in cpp.mentions if mention.path[0] in STATES}


def _is_draw(call: Call) -> bool:
    return call.name[-1:] == ("SampleDiscrete",) and call.name[0] in DRAW_SOURCES and bool(call.arguments)


def _is_constant(text: str, values: frozenset[str]) -> bool:
    """Returns whether a text in braces has nothing but literals and `values`."""
    rest = _WORD.sub(lambda word: "" if word[0] in values else word[0], _LITERAL.sub("", text))
    return text.startswith("{") and not rest


def _is_constant_table(cpp: Cpp, declaration: Declaration, values: frozenset[str], *, is_const: bool) -> bool:
    initial = declaration.initial
    assert initial is not None
    if not _is_constant(cpp.text(initial), values):
        return False
    if cpp.code[initial.end :].lstrip()[:1] == ",":
        return False  # Another variable is declared beside it.
    name = declaration.name
    if sum(other.name == name for other in cpp.declarations) != 1:
        return False
    if re.search(rf"\[[^][]*\b{name}\b[^][]*\]\s*[({{]", cpp.code):
        return False  # A lambda captures it, which it cannot once it is static.
    drawn_from = [call.arguments[-1] for call in cpp.calls if _is_draw(call)]
    weights = {weights.start for weights in drawn_from if cpp.text(weights) == name}
    return is_const or all(
        mention.access is Access.READ
        and (len(mention.path) > 1 or mention.method in _READING_METHODS or mention.extent.start in weights)
        for mention in cpp.mentions
        if mention.path[0] == name
    )
