"""Statements of C++ that do nothing, and settings where a comparison is meant, by their syntax trees."""

from tree_sitter import Node

from aos_language.cpp.nodes import below, field_of, text_of

_PLAIN = frozenset({"field_expression", "identifier", "number_literal", "string_literal", "true", "false"})
"""Expressions that do nothing but have a value."""
_PARTS_OF_VALUES = _PLAIN | {
    "binary_expression", "field_identifier", "parenthesized_expression", "subscript_argument_list",
    "subscript_expression", "unary_expression",
}  # fmt: skip
"""The named parts of an expression that changes nothing."""


def idle_parts(statement: Node) -> tuple[list[Node], list[Node]]:
    """Returns each `==` of a statement that only compares, and the whole of another that only has a value."""
    whole = statement.named_children[0] if statement.named_children else None
    if whole is not None and whole.type == "conditional_expression":  # x == is_met ? done : failed;
        condition, *branches = whole.named_children
        whole = condition if all(branch.type in _PLAIN for branch in branches) else None
    if whole is None:
        return [], []
    compared = [part for part in whole.children if part.type == "=="]
    return compared, [whole] if not compared and _only_has_a_value(whole) else []


def is_turned(assignment: Node) -> bool:
    """Returns whether a `+` stands right behind the sign, as in `x =+ 1`."""
    operator, right = (field_of(assignment, part) for part in ("operator", "right"))
    if operator is None or right is None or operator.end_byte != right.start_byte:
        return False
    return text_of(right).startswith("+") and not text_of(right).startswith("++")


def is_condition(node: Node, prefix: int) -> bool:
    """Returns whether an assignment is a whole condition. In a second pair of brackets it is meant so; those
    before the prefix are not of the code."""
    outer = node.parent
    if outer is None or outer.type == "condition_clause":
        return outer is not None
    if outer.type != "parenthesized_expression":
        return outer.type == "for_statement" and node == field_of(outer, "condition")
    is_in_brackets_of_code = outer.start_byte >= prefix
    owner = outer.parent
    if owner is None or not is_in_brackets_of_code:
        return not is_in_brackets_of_code
    is_owned = owner.type in ("conditional_expression", "do_statement")
    return is_owned and outer == field_of(owner, "condition")


def _only_has_a_value(node: Node) -> bool:
    """Returns whether an expression changes nothing; what `<<` and `>>` do is up to their operands."""
    return not node.has_error and all(
        part.type in _PARTS_OF_VALUES if part.is_named else part.type not in ("<<", ">>")
        for part in below(node)
    )
