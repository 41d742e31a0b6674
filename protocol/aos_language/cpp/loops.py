"""The loops of a C++ snippet in which it draws, and the variables that live across their rounds.

A `for` that counts is left out: no two of its rounds begin alike. So is a loop whose variables cannot be told
from the text, such as one in a lambda that names what it captures.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec
from msgspec.structs import replace
from tree_sitter import Node

from aos_language.cpp.facts import Cpp
from aos_language.cpp.keywords import DRAW_SOURCES
from aos_language.cpp.tree import Places, below, field_of, text_of, tree_of


class Scope(msgspec.Struct, frozen=True):
    """The names that a snippet finds when it begins, and those that it leaves to the next one of its
    function.

    `variables` are the names of variables; `lambdas` are those of lambdas, `drawing` those of them that draw,
    and `captured` is every name that a lambda's text has.
    """

    variables: frozenset[str] = frozenset()
    lambdas: frozenset[str] = frozenset()
    drawing: frozenset[str] = DRAW_SOURCES
    captured: frozenset[str] = frozenset()

    def with_variables(self, names: Iterable[str]) -> Scope:
        return replace(self, variables=self.variables.union(names))


class DrawingLoop(msgspec.Struct, frozen=True):
    """A loop, by offsets in the snippet.

    `start` and `end` are those of the statement, `head` and `head_end` those of its condition, which is true
    where it is left out. `mentioned` are the variables that the loop's text names, `others` those that it
    sees besides. `is_in_function`: in a lambda or a function, where a pointer may lead to what the loop does
    not see.
    """

    start: int
    end: int
    head: int
    head_end: int
    mentioned: tuple[str, ...]
    others: tuple[str, ...]
    is_in_function: bool


class Loops(msgspec.Struct, frozen=True):
    """`unset`: where declarators of variables without a value end. `after`: the scope at the end."""

    loops: tuple[DrawingLoop, ...]
    unset: tuple[int, ...]
    after: Scope


def loops_of(cpp: Cpp, scope: Scope, *, are_declarations: bool = False) -> Loops:
    """The drawing loops of a snippet that is a part of a function body, or functions among declarations."""
    if cpp.is_empty or cpp.faults:
        return Loops((), (), scope)
    complete = cpp.complete
    before = "namespace f {" if are_declarations else "void f() {"
    root = tree_of(f"{before}{complete}\n}}")
    if root.has_error:
        return Loops((), (), scope)
    return _Reading(root, cpp, (before, complete), scope).loops()


_LOOPS = ("while_statement", "do_statement", "for_statement")
_COMPARISONS = ("<", "<=", ">", ">=", "!=")


class _Reading:
    def __init__(self, root: Node, cpp: Cpp, text: tuple[str, str], scope: Scope) -> None:
        before, complete = text
        self._body = root.children[0].child_by_field_name("body") or root
        self._offset = Places(cpp.code, complete, len(before), cpp.missing_semicolons).offset
        self._before_it = scope
        self._scope = self._with_lambdas(scope)

    def loops(self) -> Loops:
        loops = [loop for node in below(self._body) if (loop := self._loop(node)) is not None]
        unset = [self._offset(end) for node in below(self._body) for end in _unset(node)]
        declared = [found for node in self._body.named_children for found in _declared(node)]
        own = {name for name, is_constant in declared if not is_constant}
        after = self._scope.with_variables(own - self._scope.lambdas)
        return Loops(tuple(loops), tuple(unset), after)

    def _with_lambdas(self, scope: Scope) -> Scope:
        lambdas, drawing, captured = set(scope.lambdas), set(scope.drawing), set(scope.captured)
        others: set[str] = set()
        for node in below(self._body):
            if "declaration" in node.type:
                others |= {name for name, _ in _declared(node, of_lambdas=False)}
            if node.type != "lambda_expression":
                continue
            names = _names(node)
            captured |= names
            if node.parent is not None and node.parent.type == "init_declarator":
                named = {name for name, _ in _names_of_declarator(node.parent)}
                lambdas |= named
                if names & drawing:
                    drawing |= named
        return Scope(scope.variables, frozenset(lambdas - others), frozenset(drawing), frozenset(captured))

    def _loop(self, node: Node) -> DrawingLoop | None:
        if node.type not in _LOOPS or not _names(node) & self._scope.drawing or _counts(node):
            return None
        head = self._head(node)
        visible = _visible(node, self._scope.variables, self._before_it.lambdas)
        if head is None or visible is None:
            return None
        mentioned = _names(node) | self._scope.captured
        variables = visible - self._scope.lambdas
        return DrawingLoop(
            self._offset(node.start_byte),
            self._offset(node.end_byte),
            *head,
            tuple(sorted(variables & mentioned)),
            tuple(sorted(variables - mentioned)),
            _is_in_function(node),
        )

    def _head(self, loop: Node) -> tuple[int, int] | None:
        condition = field_of(loop, "condition")
        if condition is None:
            if loop.type != "for_statement":
                return None
            last = [child for child in loop.children if child.type == ";"]
            place = self._offset((last[-1] if last else loop).start_byte)
            return (place, place) if last else None
        start, end = condition.start_byte, condition.end_byte
        if (
            condition.type in ("condition_clause", "parenthesized_expression")
            and loop.type != "for_statement"
        ):
            start, end = start + 1, end - 1
            if any(
                "declaration" in child.type or child.type == "init_statement" for child in condition.children
            ):
                return None
        return self._offset(start), self._offset(end)


def _visible(loop: Node, around: frozenset[str], lambdas: frozenset[str]) -> frozenset[str] | None:
    """The variables that may change and that a loop's condition sees; None where its text does not tell."""
    visible: list[tuple[str, bool]] = []
    initializer = field_of(loop, "initializer")
    if initializer is not None:
        visible += _declared(initializer)
    child, parent = loop, loop.parent
    while parent is not None:
        if parent.type == "function_definition":
            visible += _parameters(parent)
            break
        if parent.type == "lambda_expression":
            captures = field_of(parent, "captures")
            if captures is None or text_of(captures).replace(" ", "") != "[&]":
                return None
            visible += _parameters(parent)
        for sibling in parent.children:
            if sibling == child:
                break
            if any(
                part.type == "function_declarator" for part in sibling.children_by_field_name("declarator")
            ):
                return None
            visible += _declared(sibling)
        if parent.type == "for_range_loop":
            visible += _names_of_declarator(field_of(parent, "declarator"))
        child, parent = parent, parent.parent
    names = [name for name, _ in visible]
    if len(names) != len(set(names)) or not (around | lambdas).isdisjoint(names):
        return None  # One hides another, which may change all the same.
    return around | {name for name, is_constant in visible if not is_constant}


def _is_in_function(loop: Node) -> bool:
    parent = loop.parent
    while parent is not None and parent.type not in ("lambda_expression", "function_definition"):
        parent = parent.parent
    # A snippet is the body of a function of its own, at the top.
    above = parent.parent if parent is not None else None
    return above is not None and above.type != "translation_unit"


def _parameters(function: Node) -> list[tuple[str, bool]]:
    parts = below(field_of(function, "declarator"))
    return [found for part in parts if "parameter_declaration" in part.type for found in _declared(part)]


def _declared(node: Node, *, of_lambdas: bool = True) -> list[tuple[str, bool]]:
    """The variables that a statement declares for those after it, each with whether it is constant.

    Without `of_lambdas`, those are left out that are lambdas without a state of their own.
    """
    if node.type in ("init_statement", "condition_clause"):
        return [found for child in node.named_children for found in _declared(child)]
    if node.type not in ("declaration", "parameter_declaration", "optional_parameter_declaration"):
        return []
    words = {
        text_of(child)
        for child in node.children
        if child.type in ("type_qualifier", "storage_class_specifier")
    }
    found = []
    for declarator in node.children_by_field_name("declarator"):
        value = field_of(declarator, "value")
        if not of_lambdas and _is_lambda(value):
            continue
        is_constant = bool(words & {"const", "constexpr"}) and "pointer" not in _inner(declarator).type
        found += [(name, is_constant) for name, _ in _names_of_declarator(declarator)]
    return found


def _is_lambda(value: Node | None) -> bool:
    """Returns whether it is a lambda that keeps nothing from call to call."""
    is_lambda = value is not None and value.type == "lambda_expression"
    return is_lambda and not any(text_of(part) == "mutable" for part in below(value))


def _inner(declarator: Node) -> Node:
    if declarator.type != "init_declarator":
        return declarator
    return field_of(declarator, "declarator") or declarator


def _names_of_declarator(declarator: Node | None) -> list[tuple[str, bool]]:
    waiting = [_inner(declarator)] if declarator is not None else []
    found: list[tuple[str, bool]] = []
    while waiting:
        part = waiting.pop()
        if part.type == "identifier":
            found.append((text_of(part), False))
        elif part.type == "array_declarator":
            inner = field_of(part, "declarator")
            waiting += [inner] if inner is not None else []
        elif part.type != "function_declarator":
            waiting += part.named_children
    return found


def _unset(node: Node) -> Iterator[int]:
    """Yields the ends of the declaration's variables without a first value."""
    if node.type != "declaration" or any(child.type == "storage_class_specifier" for child in node.children):
        return
    if field_of(node, "value") is not None:  # `if (int n = count())`
        return
    for declarator in node.children_by_field_name("declarator"):
        if declarator.type in ("identifier", "array_declarator", "pointer_declarator"):
            yield declarator.end_byte


def _counts(loop: Node) -> bool:
    """Returns whether it is a `for` over a variable that only its last part changes."""
    update, condition = field_of(loop, "update"), field_of(loop, "condition")
    body = field_of(loop, "body")
    if loop.type != "for_statement" or update is None or condition is None or body is None:
        return False
    counters = {
        text_of(target)
        for part in below(update)
        if part.type in ("update_expression", "assignment_expression")
        and (target := field_of(part, "argument") or field_of(part, "left")) is not None
    }
    compared: set[str] = set()
    waiting = [condition]
    while waiting:
        part = waiting.pop()
        operator = field_of(part, "operator")
        if part.type == "binary_expression" and operator is not None and text_of(operator) in ("&&", "and"):
            waiting += part.named_children
        elif part.type == "binary_expression" and operator is not None and text_of(operator) in _COMPARISONS:
            compared |= {text_of(side) for side in part.named_children if side.type == "identifier"}
    return bool((counters & compared) - _changed(body))


def _changed(body: Node) -> set[str]:
    """The names that a statement assigns to, or makes a reference or a pointer of."""
    changed: set[str] = set()
    for part in below(body):
        if part.type in ("update_expression", "pointer_expression"):
            changed |= _root(field_of(part, "argument"))
        elif part.type == "assignment_expression":
            changed |= _root(field_of(part, "left"))
        elif part.type == "init_declarator" and _inner(part).type == "reference_declarator":
            changed |= _root(field_of(part, "value"))
    return changed


def _root(place: Node | None) -> set[str]:
    """The variable that a place is a part of: `a` of `a[i].b`."""
    while place is not None and place.type != "identifier":
        named = place.named_children[:1] if place.type == "parenthesized_expression" else []
        place = field_of(place, "argument") or next(iter(named), None)
    return {text_of(place)} if place is not None else set()


def _names(node: Node | None) -> set[str]:
    """The identifiers below a node, also those before `::`, as `AOSUtils`."""
    return {text_of(part) for part in below(node) if part.type in ("identifier", "namespace_identifier")}
