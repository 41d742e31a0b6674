"""Draws that a result of C++ statements is a linear function of, and that nothing else sees.

The reading is of the text. Where the text leaves a doubt, the answer is no.
"""

import re
from collections.abc import Iterator

from tree_sitter import Node

from aos_language.cpp.facts import Cpp
from aos_language.cpp.flow import is_draw
from aos_language.cpp.tree import below, field_of, field_text, operator_of, text_of, tree_of

_CONTINUOUS = ("SampleNormal", "SampleUniform")
_DOUBLE = ("double", "auto")


def linear_draws(cpp: Cpp, result: str, elsewhere: frozenset[str]) -> tuple[bool, ...]:
    """Returns for each `SampleNormal` and `SampleUniform`, in order, whether `result` is linear in it.

    Such a draw goes into `result` alone, by sums, differences, and factors and divisors that are free of it,
    maybe through local variables. `elsewhere` are names that other code knows.
    """
    root = _root(cpp)
    draws = (node for node in below(root) if is_draw(node) and _function(node) in _CONTINUOUS)
    return tuple(root is not None and _Linear(root, result, elsewhere).reaches_result(draw) for draw in draws)


def adds_only_to(cpp: Cpp, result: str) -> bool:
    """Returns whether no statement looks at `result`: each mention of it is the target of `=`, `+=` or
    `-=`."""
    if result not in cpp.code:
        return True
    root = _root(cpp)
    return root is not None and all(
        _is_added_to(node) for node in below(root) if node.type == "identifier" and text_of(node) == result
    )


def identifiers_of(cpp: Cpp) -> frozenset[str]:
    """The names that stand in it, but for those of types and members."""
    return frozenset(_identifiers(_root(cpp)))


def _is_added_to(node: Node) -> bool:
    parent = node.parent
    return (
        parent is not None
        and parent.type == "assignment_expression"
        and field_of(parent, "left") == node
        and operator_of(parent) in ("=", "+=", "-=")
        and parent.parent is not None
        and parent.parent.type == "expression_statement"
    )


class _Linear:
    """Follows one draw upwards, from expression to statement, and through local variables."""

    def __init__(self, root: Node, result: str, elsewhere: frozenset[str]) -> None:
        self._root = root
        self._result = result
        self._elsewhere = elsewhere
        self._carriers: set[str] = set()
        """The local variables that depend on the draw."""
        self._factors: list[Node] = []

    def reaches_result(self, draw: Node) -> bool:
        if not self._follows(draw):
            return False
        names = {name for factor in self._factors for name in _identifiers(factor)}
        return not names & self._carriers

    def _follows(self, node: Node) -> bool:
        parent = node.parent
        while parent is not None and self._passes_on(parent, node):
            node, parent = parent, parent.parent
        if parent is None:
            return False
        if parent.type == "assignment_expression":
            target = field_of(parent, "left")
            return target is not None and text_of(target) == self._result and _is_added_to(target)
        return parent.type == "init_declarator" and self._follows_local(parent)

    def _passes_on(self, parent: Node, node: Node) -> bool:
        if parent.type == "parenthesized_expression":
            return True
        if parent.type == "unary_expression":
            return operator_of(parent) in ("-", "+")
        if parent.type == "conditional_expression":
            return node != field_of(parent, "condition")
        if parent.type != "binary_expression":
            return False
        left, right = field_of(parent, "left"), field_of(parent, "right")
        operator = operator_of(parent)
        if left is None or right is None:
            return False
        if operator == "*" or (operator == "/" and node == left):
            self._factors.append(right if node == left else left)
            return True
        return operator in ("+", "-")

    def _follows_local(self, declarator: Node) -> bool:
        """Returns whether it declares a plain number, once, that never changes and is passed on by each
        use."""
        name, declaration = field_of(declarator, "declarator"), declarator.parent
        kind = field_of(declaration, "type")
        if name is None or name.type != "identifier" or kind is None or text_of(kind) not in _DOUBLE:
            return False
        text = text_of(name)
        if text in self._elsewhere or text in self._carriers:
            return False
        self._carriers.add(text)
        uses = (node for node in below(self._root) if node.type == "identifier" and text_of(node) == text)
        return all(use == name or self._follows(use) for use in uses)


def _root(cpp: Cpp) -> Node | None:
    """The tree of a function with the snippet in it; None where it cannot be read."""
    if cpp.faults:
        return None
    root = tree_of(f"void f() {{{cpp.complete}\n}}")
    return None if root.has_error else root


def _identifiers(node: Node | None) -> Iterator[str]:
    return (text_of(part) for part in below(node) if part.type == "identifier")


def _function(draw: Node) -> str:
    """The last name of what is called."""
    name: str = re.findall(r"\w+", field_text(draw, "function"))[-1]
    return name
