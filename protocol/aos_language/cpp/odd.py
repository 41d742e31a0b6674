"""Code that C++ takes for another than most people mean by it, by its syntax tree."""

import re
from collections.abc import Iterator

import tree_sitter

from aos_language.cpp.nodes import below, operator_of, text_of

_WHOLE = re.compile(r"0|[1-9][0-9]*")
_ORDERS = ({"<", "<="}, {">", ">="})
_LEAVING = ("break_statement", "continue_statement", "goto_statement", "return_statement", "throw_statement")

Odd = tuple[tree_sitter.Node, str, str]


def odd_parts(node: tree_sitter.Node) -> Iterator[Odd]:
    """Yields the place, a message and a hint."""
    if node.type == "binary_expression" and len(node.children) == 3:
        yield from _calculated(node)
    elif node.type == "if_statement" and node.child_by_field_name("alternative") is None:
        body = node.child_by_field_name("consequence")
        if body is not None and text_of(body) == ";":
            yield body, "this semicolon ends the `if`", "Take it out"
    elif node.type == "case_statement" and _is_case(node.next_named_sibling):
        parts = [part.type for part in below(node)]
        if ";" in parts and "fall" not in text_of(node) and not {*_LEAVING, "ERROR"} & {*parts}:
            hint = "Write `break;` at its end, or `[[fallthrough]];` where this is meant"
            yield node.children[0], "what stands here goes on into the next `case`", hint


def _is_case(node: tree_sitter.Node | None) -> bool:
    return node is not None and node.type == "case_statement"


def _calculated(node: tree_sitter.Node) -> Iterator[Odd]:
    left, sign, right = node.children
    operator, first, second = map(text_of, (sign, left, right))
    if operator == "/" and _WHOLE.fullmatch(first) and _WHOLE.fullmatch(second) and int(second):
        if int(first) % int(second):
            text = f"`{text_of(node)}` is {int(first) // int(second)} in C++"
            yield node, text, f"Write `{first}.0 / {second}`"
    elif operator == "^" and second in ("2", "3"):
        yield sign, "`^` is no power in C++", f"Write `std::pow({first}, {second})`"
    elif left.type == "binary_expression" and any({operator, operator_of(left)} <= each for each in _ORDERS):
        hint = f"Write `{first} && {text_of(left.children[2])} {operator} {second}`"
        yield node, f"this compares the truth of `{first}` with `{second}`", hint
