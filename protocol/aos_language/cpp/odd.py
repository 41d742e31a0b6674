"""Code that C++ takes for another than most people mean by it, or that does nothing, by its syntax tree."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from tree_sitter import Node

from aos_language.cpp.tree import below, child_of, field_of, field_text, operator_of, text_of

_WHOLE = re.compile(r"0|[1-9][0-9]*")
_DECIMAL = re.compile(r"0?\.\d*[1-9]\d*")
_ORDERS = ({"<", "<="}, {">", ">="})
_COMPARING = frozenset({"==", "!=", "<", "<=", ">", ">="})
_FIXED = ("char_literal", "identifier", "number_literal", "string_literal")
_GIVING = re.compile(
    r"AOS\w*(\.|::)(Bernoulli|Sample\w+)|std::(clamp|max|min|remove|remove_if|unique)|.*\.empty"
)
_OF_STATE = re.compile(r"\*?state_*\.")
_PART_OF_STATE = re.compile(r"\*?state_*(?:(?:\.|->)\w+|\[[\w.]+\])*")
_STEADY = re.compile(r"[\w.\[\]]+")
_LIBRARY = re.compile(r"(?:AOS\w*|std)\W.*|__\w+|\w*(?:max|min|pow|sqrt|abs|round|int|double)", re.DOTALL)
_LEAVING = ("break_statement", "continue_statement", "goto_statement", "return_statement", "throw_statement")


class Odd(NamedTuple):
    """An `OddPart` at its place in the tree."""

    place: Node
    message: str
    hint: str
    of_enums: tuple[str, ...] = ()
    local: str = ""


def odd_parts(node: Node) -> Iterator[Odd]:
    """Yields what is odd about a node, those below it apart."""
    if node.type == "binary_expression" and len(node.children) == 3:
        yield from _calculated(node)
    elif node.type == "conditional_expression":
        condition = node.named_children[0]
        if condition.type == "binary_expression" and operator_of(condition) == "+":
            told = f"`+` binds before `?`: the condition is `{text_of(condition)}`"
            yield Odd(condition, told, "Put what stands behind the `+` in brackets")
    elif node.type == "expression_statement" and node.named_children:
        whole = node.named_children[0]
        if _GIVING.fullmatch(function := field_text(whole, "function")):
            yield Odd(whole, f"nothing takes what `{function}` gives", f"Write `NAME = {text_of(whole)};`")
        elif whole.type == "assignment_expression":
            yield from _set_oddly(whole)
            yield from _set_again(whole, node)
    elif node.type == "declaration":
        yield from _copied_variable(node)
    elif node.type == "for_range_loop":
        yield from _copied(node)
    elif node.type == "if_statement" and field_of(node, "alternative") is None:
        body = field_of(node, "consequence")
        if body is not None and text_of(body) == ";":
            yield Odd(body, "this semicolon ends the `if`", "Take it out")
    elif node.type == "else_clause" and text_of(node.children[-1]) == ";":
        yield Odd(node.children[-1], "this semicolon ends the `else`", "Take it out")
    elif node.type == "case_statement" and getattr(node.next_named_sibling, "type", "") == node.type:
        parts = [part.type for part in below(node)]
        if _only_breaks(node.next_named_sibling):
            return
        if ";" in parts and "fall" not in text_of(node) and not {*_LEAVING, "ERROR"} & {*parts}:
            hint = "Write `break;` at its end, or `[[fallthrough]];` where this is meant"
            yield Odd(node.children[0], "what stands here goes on into the next `case`", hint)


def _copied(loop: Node) -> Iterator[Odd]:
    """Yields the copies of the state's elements that a loop only sets."""
    declared = field_of(loop, "declarator")
    if declared is None or not _OF_STATE.match(field_text(loop, "right")):
        return
    is_bound = declared.type == "structured_binding_declarator"
    for name in declared.named_children if is_bound else [declared]:
        used = [part for part in below(field_of(loop, "body")) if text_of(part) == text_of(name)]
        if used and all(_is_only_set(part, whole=True) for part in used):
            yield Odd(
                used[0], f"`{text_of(name)}` is a copy: this changes nothing", "Declare it with `auto&`"
            )


def _copied_variable(node: Node) -> Iterator[Odd]:
    """Yields a copy of the state, or of a part, that is only set: `auto box = state__.box; box.x = 1;`."""
    declared = field_of(node, "declarator")
    if declared is None or declared.type != "init_declarator" or node.parent is None:
        return
    name, value = text_of(child_of(declared, "declarator")), field_text(declared, "value")
    if not name.isidentifier() or not _PART_OF_STATE.fullmatch(value):
        return
    used = [
        part
        for part in below(node.parent)
        if part.type == "identifier" and text_of(part) == name and part.start_byte > declared.end_byte
    ]
    whole = field_text(node, "type") == "auto"  # As with the bit of a vector, which C++ binds.
    if used and all(_is_only_set(part, whole=whole) for part in used):
        hint = f"Declare it with `auto& {name} = {value}`"
        yield Odd(used[0], f"`{name}` is a copy: this changes nothing", hint, local=name)


def _set_oddly(setting: Node) -> Iterator[Odd]:
    """Yields what is set to itself, and `x =- 1`."""
    left, sign, right = setting.children[0], setting.children[1], setting.children[-1]
    name = text_of(left)
    if text_of(sign) != "=":
        return
    if name == text_of(right) and _STEADY.fullmatch(name):
        yield Odd(setting, f"`{name}` is set to itself", "Take it out, or name what it is to be")
    elif right.start_byte == sign.end_byte and re.match(r"-\s", text_of(right)):
        yield Odd(sign, "`=-` subtracts nothing: it sets", "To subtract, write `-=`")


def _set_again(setting: Node, statement: Node) -> Iterator[Odd]:
    """Yields what the next statement sets anew without having read it."""
    later = statement.next_named_sibling
    while later is not None and later.type == "comment":
        later = later.next_named_sibling
    if later is None or later.type != "expression_statement" or not later.named_children:
        return
    after = later.named_children[0]
    if after.type != "assignment_expression":
        return
    name, signs = field_text(setting, "left"), {operator_of(setting), operator_of(after)}
    if signs != {"="} or name != field_text(after, "left") or not _STEADY.fullmatch(name):
        return
    value = child_of(after, "right")
    calls = [field_text(part, "function") for part in below(value) if part.type == "call_expression"]
    parts = re.findall(r"\w+", name)
    reads = re.search(rf"\b{parts[0]}\b|->\s*{parts[-1]}\b", text_of(value))
    if reads is None and all(_LIBRARY.fullmatch(call) for call in calls):
        told = f"`{name}` is set again before anything reads it"
        adds = "To add to it, write `__reward += ...;`" if name == "__reward" else "Take one of both out"
        yield Odd(setting.children[0], told, adds)


def _only_breaks(case: Node | None) -> bool:
    statements = case.named_children if case is not None else []
    return any(part.type == "break_statement" for part in statements[:2])


def _is_only_set(part: Node, *, whole: bool) -> bool:
    """Returns whether a statement sets a field of this name, or the whole of it, and does no more."""
    while (
        (above := part.parent) is not None and above.type == "field_expression" and operator_of(above) == "."
    ):
        part, whole = above, True
    if above is None or above.parent is None or above.parent.type != "expression_statement":
        return False
    is_set = above.type in ("assignment_expression", "update_expression")
    return whole and is_set and part in (above.children[0], field_of(above, "argument"))


def _calculated(node: Node) -> Iterator[Odd]:
    left, sign, right = node.children
    operator, first, second = map(text_of, (sign, left, right))
    if operator == "/" and _WHOLE.fullmatch(first) and _WHOLE.fullmatch(second) and int(second):
        if int(first) % int(second):
            text = f"`{text_of(node)}` is {int(first) // int(second)} in C++"
            yield Odd(node, text, f"Write `{first}.0 / {second}`")
    elif operator == "^" and second in ("2", "3"):
        yield Odd(sign, "`^` is no power in C++", f"Write `std::pow({first}, {second})`")
    elif left.type == "binary_expression" and any({operator, operator_of(left)} <= each for each in _ORDERS):
        hint = f"Write `{first} && {text_of(left.children[2])} {operator} {second}`"
        yield Odd(node, f"this compares the truth of `{first}` with `{second}`", hint)
    elif operator in _COMPARING and operator_of(left) == "!" and right.type in _FIXED:
        hint = f"Write `!({first[1:]} {operator} {second})`"
        yield Odd(node, f"`!` binds first: this compares `{first}`", hint, _names(right))
    elif operator in "&|" and operator_of(right) in _COMPARING and right.children[0].type == "number_literal":
        hint = f"Write `({first} {operator} {text_of(right.children[0])})`"
        yield Odd(node, f"`{operator_of(right)}` binds first: this is `{first} {operator} ({second})`", hint)
    elif operator in ("&&", "||") and (odds := [p for p in (left, right) if _DECIMAL.fullmatch(text_of(p))]):
        text = text_of(odds[0])
        yield Odd(odds[0], f"`{text}` is always true here", f"Write `AOS.Bernoulli({text})` for a chance")
    elif operator in ("&&", "||"):
        while operator_of(left) == operator:
            left = left.children[2]
        if operator_of(left) in ("==", "!=") and len(left.children) == 3:  # Else it does not parse.
            yield from _joined(left, operator, right)


def _joined(left: Node, operator: str, right: Node) -> Iterator[Odd]:
    """Yields a second condition that compares nothing, or that says nothing together with the first."""
    subject, sign, value = map(text_of, left.children)
    if right.type in _FIXED:
        hint = f"Write `{subject} {sign} {text_of(right)}`"
        yield Odd(right, f"`{text_of(right)}` is compared with nothing here", hint, _names(right))
    elif operator_of(right) == sign == ("!=" if operator == "||" else "=="):
        given = left.children[2], right.children[2]
        are_fixed = {part.type for part in given} <= {*_FIXED} and value != text_of(given[1])
        if are_fixed and text_of(right.children[0]) == subject and "(" not in subject:
            told, other = ("always", "&&") if operator == "||" else ("never", "||")
            yield Odd(
                right, f"with what stands before it, this {told} holds", f"Write `{other}`", _names(*given)
            )


def _names(*parts: Node) -> tuple[str, ...]:
    return tuple(text_of(part) for part in parts if part.type == "identifier")


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
