"""The conditions under which C++ statements earn a reward above 0 or end at a goal, as edits that count them.

`if (all_closed && state.at == 3) __reward = 50;` asks for two conditions. What a local variable stands for is
followed: a flag that a loop clears, or a number that it counts up. Where a block asks for three or more, they
count in place of its own condition: `if (state.is_shipped) __reward = all_fit ? 60 : -20;` asks what fits, as
to ship comes last. Each condition that has to hold becomes `aos_effect.holds(condition)`, each that must not
`aos_effect.fails(condition)`, and all of them are evaluated, even if one does not hold. The reading is of the
text. Where it leaves a doubt, a condition does not count.
"""

import re
from collections.abc import Iterator, Sequence

from tree_sitter import Node

from aos_language.cpp.facts import Cpp
from aos_language.cpp.tokens import Extent
from aos_language.cpp.tree import below, field_of, field_text, operator_of, text_of, tree_of

Edits = tuple[tuple[Extent | int, str], ...]

_IN_A_LOOP = 3
"""A condition in a loop counts as so many: rounds are not counted."""
_ENOUGH = 3
"""Fewer conditions are found together by a search for new pairs of values."""
_ALL = {True: "& aos::evaluate_all &", False: "| aos::evaluate_all |"}
_BEFORE = {False: "void f() {", True: "auto x = ("}
_LOOPS = ("for_statement", "for_range_loop", "while_statement", "do_statement")
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
_MAY_FAIL = ("call_expression", "update_expression", "assignment_expression", "pointer_expression")
_MATHS = re.compile(r"(?:std::)?(?:f?abs|hypot|min|max|sqrt)")
_OPPOSITE = {"==": "!=", "!=": "==", ">=": "<", "<": ">=", ">": "<=", "<=": ">"}


def counted_conditions(parts: Sequence[Cpp], *, is_expression: bool = False) -> tuple[Edits, ...]:
    """The edits of each part of a section; empty where fewer than three conditions are asked for.

    With `is_expression` the one part is the condition of a reward or goal.
    """
    roots = [_root(cpp, is_expression) for cpp in parts]
    if any(root is None for root in roots):
        return ()
    reading = _Reading([root for root in roots if root is not None])
    if is_expression:
        reading.want(next(n for n in below(roots[0]) if n.type == "parenthesized_expression"), True)
    else:
        reading.want_rewards()
    if reading.count < _ENOUGH:
        return ()
    offset = len(_BEFORE[is_expression])
    return tuple(_placed(edits, offset) for edits in reading.edits)


def _root(cpp: Cpp, is_expression: bool) -> Node | None:
    if cpp.faults or not cpp.code.isascii() or len(cpp.missing_semicolons) > 1:
        return None
    root = tree_of(_BEFORE[is_expression] + cpp.complete + ("\n);" if is_expression else "\n}"))
    return None if root.has_error else root


def _placed(edits: list[tuple[int, int, str]], offset: int) -> Edits:
    return tuple(
        (start - offset if end == start else Extent(start - offset, end - offset), text)
        for start, end, text in edits
    )


class _Reading:
    """One walk back from rewards and goals to what they ask for."""

    def __init__(self, roots: list[Node]) -> None:
        self.count = 0
        self.edits: list[list[tuple[int, int, str]]] = [[] for _ in roots]
        self._nodes = [(number, node) for number, root in enumerate(roots) for node in below(root)]
        self._numbers = {node.id: number for number, node in self._nodes}
        self._read: set[tuple[str, bool]] = set()
        self._counted: set[int] = set()
        self._locals = {name for _, node in self._nodes for name in _declared(node)}

    def want_rewards(self) -> None:
        """Reads all statements that earn something or reach a goal."""
        for _, node in self._nodes:
            left, right = field_of(node, "left"), field_of(node, "right")
            if node.type != "assignment_expression" or left is None or right is None:
                continue
            is_goal = text_of(left) == "__isGoalState" and not _is_punished(node)
            if not is_goal and (text_of(left) != "__reward" or operator_of(node) not in ("=", "+=")):
                continue
            if right.type == "conditional_expression":
                self._want_choice(right, True)
            elif is_goal and right.type not in ("true", "number_literal"):
                self.want(right, True)
            if _is_positive(right):
                self._want_place(node, True)

    def want(self, node: Node, truth: bool) -> None:
        """Counts the conditions under which an expression is so."""
        left, right = field_of(node, "left"), field_of(node, "right")
        if node.type == "parenthesized_expression":
            self.want(node.named_children[0], truth)
        elif node.type == "unary_expression" and operator_of(node) == "!":
            self.want(node.named_children[-1], not truth)
        elif node.type == "binary_expression" and operator_of(node) == ("&&" if truth else "||"):
            assert left is not None
            assert right is not None
            self.want(left, truth)
            self.want(right, truth)
            sign = field_of(node, "operator")
            if sign is not None and _cannot_fail(right):
                self._edit(node, sign.start_byte, sign.end_byte, _ALL[truth])
        elif node.type == "identifier" and text_of(node) in self._locals:
            self._want_flag(text_of(node), truth)
        elif not self._want_number(node, truth):
            self._count(node, truth)

    def _want_choice(self, node: Node, truth: bool) -> bool:
        """Counts what a choice between two values depends on, if one of them is what is wanted."""
        condition = field_of(node, "condition")
        first, second = (field_of(node, name) for name in ("consequence", "alternative"))
        if condition is None or first is None or second is None:
            return False
        if _is_positive(first) != _is_positive(second):
            self.want(condition, truth == _is_positive(first))
        return True

    def _want_flag(self, name: str, truth: bool) -> None:
        if (name, truth) in self._read:
            return
        self._read.add((name, truth))
        for node, value in self._set(name):
            literal = _BOOLEANS.get(text_of(value))
            if literal is None:
                self.want(value, truth)
            elif node.type != "init_declarator":
                self._want_place(node, truth == literal)

    def _want_number(self, node: Node, truth: bool) -> bool:
        """Counts what a number is made of that is compared, as `closed == 5`; returns whether it is one."""
        left, right = field_of(node, "left"), field_of(node, "right")
        operator = operator_of(node)
        if left is None or right is None or operator not in _OPPOSITE or left.type != "identifier":
            return False
        name, operator = text_of(left), operator if truth else _OPPOSITE[operator]
        steps = [
            n for _, n in self._nodes if n.type == "update_expression" and field_text(n, "argument") == name
        ]
        sums = [
            (n, value)
            for n, value in self._set(name)
            if value.type != "number_literal" or "+" in operator_of(n)
        ]
        if name not in self._locals or not (steps or sums) or operator == "!=":
            return False
        has_more = operator in (">", ">=") or (operator == "==" and text_of(right) != "0")
        if (name, has_more) in self._read:
            return True
        self._read.add((name, has_more))
        for step in steps:
            self._want_place(step, has_more == ("++" in text_of(step)))
        for assignment, value in sums:
            is_more = has_more != ("-" in operator_of(assignment))
            if value.type == "number_literal":
                self._want_place(assignment, is_more)
            else:
                self._want_sum(value, is_more)
        return True

    def _want_sum(self, node: Node, more: bool) -> None:
        if node.type == "parenthesized_expression":
            self._want_sum(node.named_children[0], more)
        elif node.type == "binary_expression" and operator_of(node) == "+":
            for part in node.named_children:
                self._want_sum(part, more)
        elif node.type == "conditional_expression":
            self._want_choice(node, more)
        elif node.type not in ("identifier", "number_literal"):
            self.want(node, more)

    def _want_place(self, node: Node, truth: bool) -> None:
        """Counts the conditions under which a statement runs; one of them is enough to keep it from that."""
        child = node
        while (parent := child.parent) is not None:
            if truth:
                self._want_no_exit(parent, child)
            condition = field_of(parent, "condition")
            if parent.type == "if_statement" and condition is not None and child != condition:
                is_first = field_of(parent, "consequence") == child
                if truth and is_first and self._asks_enough(parent, child, condition):
                    self._enter(condition)
                else:
                    self.want(condition.named_children[-1], truth == is_first)
                if not truth:
                    self._drop_break(child)
                    return
            child = parent

    def _asks_enough(self, statement: Node, block: Node, condition: Node) -> bool:
        """Returns whether what a block asks for is counted where it is not entered, too."""
        if field_of(statement, "alternative") is not None or _is_in_loop(statement) or _may_crash(block):
            return False
        is_plain = [child.type for child in condition.named_children] not in ([], ["declaration"])
        counted = [node for node in below(block) if node.id in self._counted]
        return is_plain and len(condition.named_children) == 1 and sum(map(_weight, counted)) >= _ENOUGH

    def _enter(self, condition: Node) -> None:
        start, end = condition.start_byte, condition.end_byte
        self._edit(condition, start, start + 1, "(aos_effect.entered(")
        self._edit(condition, end - 1, end, "))")

    def _want_no_exit(self, block: Node, before: Node) -> None:
        for statement in block.named_children:
            if statement == before:
                return
            then, condition = (field_of(statement, name) for name in ("consequence", "condition"))
            if statement.type != "if_statement" or then is None or condition is None:
                continue
            if re.fullmatch(r"\{?\s*(?:return|continue);\s*\}?", text_of(then)):
                self.want(condition.named_children[-1], False)

    def _drop_break(self, block: Node) -> None:
        loop = block
        while loop.parent is not None and loop.type not in _LOOPS:
            loop = loop.parent
        for statement in block.named_children if loop.type == _LOOPS[0] else []:
            if statement.type == "break_statement":
                self._edit(block, statement.start_byte, statement.end_byte, ";")

    def _set(self, name: str) -> Iterator[tuple[Node, Node]]:
        """The declarations and assignments of a local variable that give it a value."""
        for _, node in self._nodes:
            if node.type == "init_declarator":
                target, value = (field_of(node, field) for field in ("declarator", "value"))
            elif node.type == "assignment_expression":
                target, value = (field_of(node, field) for field in ("left", "right"))
            else:
                continue
            if target is not None and value is not None and text_of(target) == name:
                yield node, value

    def _count(self, node: Node, truth: bool) -> None:
        if node.id in self._counted or re.search(r"\bAOS|\[[=&\w, ]*\]\s*\(", text_of(node)):
            return
        if node.type in ("true", "false", "number_literal", "declaration", *_MAY_FAIL[1:3]):
            return
        self._counted.add(node.id)
        self.count += _weight(node)
        self._edit(node, node.start_byte, node.start_byte, f"aos_effect.{'holds' if truth else 'fails'}(")
        self._edit(node, node.end_byte, node.end_byte, ")")

    def _edit(self, node: Node, start: int, end: int, text: str) -> None:
        edits = self.edits[self._numbers[node.id]]
        if (start, end, text) not in edits or end == start:
            edits.append((start, end, text))


def _declared(node: Node) -> Iterator[str]:
    if node.type == "declaration":
        for declarator in node.children_by_field_name("declarator"):
            inner = field_of(declarator, "declarator")
            yield text_of(inner if inner is not None else declarator)


def _is_positive(node: Node) -> bool:
    """Returns whether a value may be above 0, for all that its text tells."""
    text = text_of(node).strip("( )")
    return not text.startswith("-") and text != "false" and not re.fullmatch(r"[0.]+f?", text)


def _is_punished(node: Node) -> bool:
    """Returns whether the block of a statement costs something."""
    block = node.parent.parent if node.parent is not None else None
    return block is not None and any(
        re.match(r"__reward\s*(?:-=|\+?=\s*-)", text_of(child)) for child in block.named_children
    )


def _weight(node: Node) -> int:
    return _IN_A_LOOP if _is_in_loop(node) else 1


def _is_in_loop(node: Node) -> bool:
    while (node_above := node.parent) is not None:
        if node_above.type in _LOOPS:
            return True
        node = node_above
    return False


def _may_crash(block: Node) -> bool:
    """Returns whether a block may do what only its condition keeps from going wrong."""
    return any(
        part.type == "pointer_expression"
        or (part.type == "field_expression" and "->" in text_of(part))
        or operator_of(part) in ("/", "%")
        or (part.type == "subscript_expression" and not _is_safe_index(part))
        for part in below(block)
    )


def _is_safe_index(part: Node) -> bool:
    return bool(re.match(r"state_*\.", text_of(part))) or (
        _is_in_loop(part) and "state" not in field_text(part, "indices")
    )


def _cannot_fail(node: Node) -> bool:
    """Returns whether an expression may be evaluated whatever was asked before it."""
    return not any(
        (part.type in _MAY_FAIL and not _MATHS.fullmatch(field_text(part, "function")))
        or (part.type == "field_expression" and "->" in text_of(part))
        or operator_of(part) in ("/", "%")
        or (part.type == "subscript_expression" and not re.match(r"state_*\.", text_of(part)))
        for part in below(node)
    )
