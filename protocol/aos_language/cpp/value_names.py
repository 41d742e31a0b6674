"""Names in a skill's code that are both a response and a value of an enum: where the value is meant."""

import re

from tree_sitter import Node

from aos_language.cpp.facts import Cpp, DeclarationKind
from aos_language.cpp.keywords import STATES
from aos_language.cpp.nodes import below, field_of, text_of
from aos_language.cpp.tokens import Extent, Lines
from aos_language.cpp.tree import tree_of

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
    names -= {declaration.name for declaration in cpp.declarations}
    variables = {
        d.name for d in cpp.declarations if d.kind is DeclarationKind.VARIABLE and _NUMBERS.search(d.type)
    }
    lines = Lines(cpp.code)
    return tuple(
        lines.extent(node.start_byte - len(_BEFORE), node.end_byte - len(_BEFORE))
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
