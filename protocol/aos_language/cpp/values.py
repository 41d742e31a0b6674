"""The values that an expression of C++ can have, not those of its conditions, and names that are values."""

import re
from collections.abc import Iterator

from tree_sitter import Node

from aos_language.cpp.facts import Cpp, DeclarationKind
from aos_language.cpp.keywords import STATES
from aos_language.cpp.tokens import Extent
from aos_language.cpp.tree import below, field_of, operator_of, text_of, tree_of

_VALUES = {
    "parenthesized_expression": (0,),
    "conditional_expression": (1, 2),
    "comma_expression": (-1,),
    "cast_expression": (-1,),
    "assignment_expression": (-1,),
    "subscript_expression": (0,),
}
"""The parts, by their places among the named ones, that give an expression its value."""


def value_names(expression: str) -> list[tuple[str, int]]:
    """The names with their offsets: of `is_there ? found : missed` these are `found` and `missed`.

    Of an element of an array it is the array's name, and of a list its elements'.
    """
    return [(text, offset) for kind, text, offset in values(expression) if kind == "identifier"]


def values(expression: str) -> list[tuple[str, str, int]]:
    """All that it can be the value of, each with what it is in the tree, its text and its offset.

    Behind a text in quotes and a `+` stands a value, too: that sum is no text where the value is none.
    """
    is_list = expression.lstrip().startswith("{")
    before, after = ("auto x = ", "\n;") if is_list else ("auto x = (", "\n);")
    data = f"{before}{expression}{after}".encode()
    found = []
    for node in _values(tree_of(data.decode())):
        start = len(data[: node.start_byte].decode()) - len(before)
        found.append((node.type, data[node.start_byte : node.end_byte].decode(), start))
    return found


def _values(root: Node) -> Iterator[Node]:
    waiting = [root]
    while waiting:
        node = waiting.pop()
        if node.type == "init_declarator":
            value = field_of(node, "value")
            waiting += [value] if value is not None else []
        elif node.type in ("translation_unit", "declaration", "initializer_list"):
            waiting += reversed(node.named_children)
        elif node.type in _VALUES:
            parts = [part for part in node.named_children if part.type != "comment"]
            waiting += [parts[at] for at in reversed(_VALUES[node.type]) if at < len(parts)]
        elif node.type == "binary_expression" and node.named_children[0].type == "string_literal":
            waiting += node.named_children[1:2] if operator_of(node) == "+" else []
        else:
            yield node


_COMPARING = frozenset({"==", "!=", "<", "<=", ">", ">="})
_NUMBERS = re.compile(r"\b(?:auto|char|int|long|short|signed|size_t|u?int\d+_t|unsigned)\b")
_BEFORE = "void f() {"
_WRAPPING = ("parenthesized_expression", "cast_expression", "initializer_list")


def values_meant(cpp: Cpp, names: frozenset[str]) -> tuple[Extent, ...]:
    """The places at which a name of these can only be the enum's value: compared with something of a state,
    assigned to it, the label of a switch over it, an index, an argument beside it, the start of a variable
    that is no number."""
    if not names or cpp.faults or not cpp.code.isascii() or len(cpp.missing_semicolons) > 1:
        return ()
    if names.isdisjoint(mention.path[0] for mention in cpp.mentions):
        return ()
    names -= cpp.declared
    variables = {
        d.name for d in cpp.declarations if d.kind is DeclarationKind.VARIABLE and _NUMBERS.search(d.type)
    }
    return tuple(
        Extent(node.start_byte - len(_BEFORE), node.end_byte - len(_BEFORE))
        for node in below(tree_of(_BEFORE + cpp.complete + "\n}"))
        if node.type == "identifier" and text_of(node) in names and _is_value(node, variables)
    )


def _is_value(node: Node, variables: set[str]) -> bool:
    inner, outer = node, node.parent
    while outer is not None and (
        outer.type in _WRAPPING
        or (outer.type == "conditional_expression" and inner != field_of(outer, "condition"))
    ):
        inner, outer = outer, outer.parent
    if outer is None:
        return False
    left, right = field_of(outer, "left"), field_of(outer, "right")
    if outer.type == "binary_expression":
        operator = field_of(outer, "operator")
        is_compared = operator is not None and text_of(operator) in _COMPARING
        return is_compared and _is_of_state(left if inner == right else right, variables)
    if outer.type == "assignment_expression":
        return inner == right and _is_of_state(left, variables)
    if outer.type in ("init_declarator", "for_range_loop"):
        declared = (outer.parent or outer) if outer.type == "init_declarator" else outer
        kind = field_of(declared, "type")
        return kind is not None and _NUMBERS.search(text_of(kind)) is None
    if outer.type == "case_statement":
        switch = outer.parent.parent if outer.parent is not None else None
        return switch is not None and _is_of_state(field_of(switch, "condition"), variables)
    if outer.type == "argument_list":
        return any(_mentions_state(argument) for argument in outer.named_children if argument != inner)
    return outer.type == "subscript_argument_list"


def _is_of_state(node: Node | None, variables: set[str]) -> bool:
    """Returns whether this is no response: a part of something, or a name
    that is no number of the code."""
    if node is None:
        return False
    names = [text_of(part) for part in below(node) if part.type == "identifier"]
    is_part = any(part.type in ("field_expression", "subscript_expression") for part in below(node))
    return "__moduleResponse" not in names and (is_part or (bool(names) and variables.isdisjoint(names)))


def _mentions_state(node: Node) -> bool:
    return any(part.type == "identifier" and text_of(part) in STATES for part in below(node))
