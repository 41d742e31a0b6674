"""Code that C++ takes for another than most people mean by it, by its syntax tree."""

import re
from collections.abc import Iterator

import tree_sitter

from aos_language.cpp.nodes import operator_of, text_of

_WHOLE = re.compile(r"0|[1-9][0-9]*")
_ORDERS = ({"<", "<="}, {">", ">="})
_LEAVING = ("break_statement", "continue_statement", "goto_statement", "return_statement", "throw_statement")

Odd = tuple[tree_sitter.Node, str, str]


def odd_parts(node: tree_sitter.Node) -> Iterator[Odd]:
    """Yields the place, a message and a hint."""
    if node.type == "binary_expression" and len(node.children) == 3:
        yield from _calculated(node)
    elif node.type in ("if_statement", "for_statement", "while_statement"):
        yield from _cut_off(node)
    elif node.type == "case_statement":
        yield from _fallen_through(node)


def _calculated(node: tree_sitter.Node) -> Iterator[Odd]:
    left, sign, right = node.children
    operator, first, second = text_of(sign), text_of(left), text_of(right)
    if operator == "/" and _WHOLE.fullmatch(first) and _WHOLE.fullmatch(second) and int(second):
        quotient, rest = divmod(int(first), int(second))
        if rest:
            yield node, f"`{text_of(node)}` is {quotient} in C++", f"Write `{first}.0 / {second}`"
    elif operator == "^" and second in ("2", "3"):
        yield sign, "`^` is no power in C++", f"Write `std::pow({first}, {second})`"
    elif left.type == "binary_expression" and any({operator, operator_of(left)} <= each for each in _ORDERS):
        hint = f"Write `{first} && {text_of(left.children[2])} {operator} {second}`"
        yield node, f"this compares the truth of `{first}` with `{second}`", hint


def _cut_off(node: tree_sitter.Node) -> Iterator[Odd]:
    """A semicolon in the place of what an `if` has, or of the braces behind a loop."""
    is_if, follows = node.type == "if_statement", node.next_named_sibling
    body = node.child_by_field_name("consequence" if is_if else "body")
    is_block = follows is not None and follows.type == "compound_statement"
    is_whole = is_block or (is_if and node.child_by_field_name("alternative") is None)
    if body is not None and is_whole and text_of(body) == ";":
        hint = "What stands behind it runs in any case: take the semicolon out"
        yield body, f"this semicolon ends the `{text_of(node.children[0])}`", hint


def _fallen_through(node: tree_sitter.Node) -> Iterator[Odd]:
    follows, value = node.next_named_sibling, node.child_by_field_name("value")
    body = [part for part in node.named_children if part != value and part.type != "comment"]
    is_last = follows is None or follows.type != "case_statement"
    if not is_last and body and "fall" not in text_of(node) and not _leaves(body[-1]):
        hint = "Write `break;` at its end, or `[[fallthrough]];` where this is meant"
        yield node.children[0], "what stands here goes on into the next `case`", hint


def _leaves(statement: tree_sitter.Node) -> bool:
    """Returns whether what stands behind a statement never runs."""
    if statement.type == "compound_statement":
        return any(map(_leaves, statement.named_children))
    other = statement.child_by_field_name("alternative")
    if statement.type == "if_statement" and other is not None:
        branches = (statement.child_by_field_name("consequence"), other.named_children[-1])
        return all(branch is not None and _leaves(branch) for branch in branches)
    return statement.type in _LEAVING or statement.has_error
