"""The order in which C++ expressions read local variables that may have no value yet, and set them.

`State` has those variables along the ways that lead to a place.
"""

from __future__ import annotations

from collections.abc import Iterable

import msgspec
from tree_sitter import Node

from aos_language.cpp.facts import (
    CHANGING_METHODS,
    EXCHANGING_METHODS,
    HANDLE_METHODS,
    READING_FUNCTIONS,
    READING_METHODS,
)
from aos_language.cpp.flow import is_draw, names_in
from aos_language.cpp.tree import below, field_of, field_text, operator_of, parts_of, text_of

_READING_METHODS = (CHANGING_METHODS | HANDLE_METHODS | READING_METHODS) - EXCHANGING_METHODS
_NO_READS = frozenset({
    "comment", "qualified_identifier", "type_descriptor", "template_argument_list", "sizeof_expression",
    "declaration", "init_statement", "decltype",
})  # fmt: skip


class Evaluation:
    """Reads expressions in the order in which they are evaluated, as far as it matters.

    `found` has, by where a variable is declared, its first read without a value, its type, and whether no way
    there sets it. In a `trial` nothing is told.
    """

    def __init__(self) -> None:
        self.found: dict[int, tuple[Node, str, bool]] = {}
        self.declared: dict[str, tuple[int, str]] = {}
        self.conditions: list[frozenset[str]] = []
        self.is_trial = False

    def expression(self, node: Node | None, state: State) -> None:
        """Reads and sets in the order of evaluation, as far as it matters."""
        if node is None or node.type in _NO_READS:
            return
        if node.type == "identifier":
            self._read(node, state)
        elif node.type == "assignment_expression":
            self._assign(node, state)
        elif node.type == "lambda_expression" or (node.type == "pointer_expression" and _is_address(node)):
            self.may_be_set(node, state)
        elif node.type == "call_expression":
            self._call(node, state)
        elif node.type == "binary_expression" and operator_of(node) == ">>":
            left, right = field_of(node, "left"), field_of(node, "right")
            self.expression(left, state)
            is_set = right is not None and right.type == "identifier" and self._is_stream(left)
            (self.may_be_set if is_set else self.expression)(right, state)
        elif node.type == "binary_expression" and operator_of(node) in ("&&", "||"):
            left, right = field_of(node, "left"), field_of(node, "right")
            self.expression(left, state)
            self._sometimes(left, [right], state)
        elif node.type == "conditional_expression":
            condition = field_of(node, "condition")
            self.expression(condition, state)
            parts = [field_of(node, "consequence"), field_of(node, "alternative")]
            self._sometimes(condition, parts, state)
        elif node.type == "field_expression":
            self.expression(field_of(node, "argument"), state)
        else:
            for child in node.named_children:
                self.expression(child, state)

    def _sometimes(self, condition: Node | None, parts: list[Node | None], state: State) -> None:
        """Parts that run under a condition; what one of them sets counts as set."""
        self.conditions.append(frozenset(name.text for name in names_in(condition)))
        for part in parts:
            self.expression(part, state)
        self.conditions.pop()

    def _assign(self, node: Node, state: State) -> None:
        left, right = field_of(node, "left"), field_of(node, "right")
        while left is not None and left.type == "parenthesized_expression" and left.named_child_count == 1:
            left = left.named_children[0]
        self.expression(right, state)
        if left is not None and left.type == "identifier" and operator_of(node) == "=":
            state.set(text_of(left))
        else:
            self.expression(left, state)

    def _call(self, node: Node, state: State) -> None:
        function = field_of(node, "function")
        name = field_text(node, "function").split("<")[0].removeprefix("std::")
        is_reading = name in READING_FUNCTIONS or is_draw(node)
        if function is not None and function.type == "field_expression":
            self.expression(field_of(function, "argument"), state)
            is_reading |= field_text(function, "field") in _READING_METHODS
        for argument in parts_of(node, "arguments"):
            if argument.type == "identifier" and not is_reading:
                state.set(text_of(argument))  # It may be taken by reference.
            else:
                self.expression(argument, state)

    def _is_stream(self, node: Node | None) -> bool:
        """Returns whether the first operand of `text >> first >> second` may be a stream, which sets them."""
        while node is not None and node.type == "binary_expression" and operator_of(node) == ">>":
            node = field_of(node, "left")
        return node is not None and node.type == "identifier" and text_of(node) not in self.declared

    def may_be_set(self, node: Node | None, state: State) -> None:
        for part in below(node):
            if part.type == "identifier":
                state.set(text_of(part))

    def _read(self, node: Node, state: State) -> None:
        ways = state.unset.get(text_of(node))
        declared = self.declared.get(text_of(node))
        if ways is None or declared is None or self.is_trial:
            return
        if ways.never or not any(ways.under & named for named in self.conditions):
            declared_at, kind = declared
            self.found.setdefault(declared_at, (node, kind, ways.never))


def _is_address(node: Node) -> bool:
    return node.children[0].type == "&"


class Ways(msgspec.Struct, frozen=True):
    """The ways on which a variable is without a value: all of them (`never` set), or some.

    `under` are the names in the conditions under which it was set on the others.
    """

    never: bool = True
    under: frozenset[str] = frozenset()


class State(msgspec.Struct):
    """The variables without a value on some way to a place. `ended`: no way goes on from here."""

    unset: dict[str, Ways] = {}
    ended: bool = False

    def copy(self) -> State:
        return State(dict(self.unset), self.ended)

    def set(self, name: str) -> None:
        """Notes that the name has a value from here on."""
        self.unset.pop(name, None)


def merged(states: Iterable[State], under: frozenset[str] = frozenset()) -> State:
    """The state where ways meet; `under` is what the condition names that parted them."""
    going = [state for state in states if not state.ended]
    if not going:
        return State(ended=True)
    unset = {}
    for name in {name for state in going for name in state.unset}:
        ways = [state.unset[name] for state in going if name in state.unset]
        names = frozenset[str]().union(*(way.under for way in ways))
        is_set = len(ways) < len(going)
        unset[name] = Ways(not is_set and all(way.never for way in ways), names | under if is_set else names)
    return State(unset)
