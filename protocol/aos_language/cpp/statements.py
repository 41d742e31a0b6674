"""Marks at C++ statements: code of somebody else's before each of them, also in branches, loops and lambdas.

The marked code does what the code does, on the same lines; what the marks do is up to who puts them there.
"""

from collections.abc import Callable

import msgspec
from tree_sitter import Node

from aos_language.cpp.tree import field_of, tree_of


class Statement(msgspec.Struct, frozen=True):
    """A statement of a function body: where it starts, from line and column 1, in characters."""

    line: int
    column: int
    text: str


class Marks(msgspec.Struct, frozen=True):
    """The code to put in.

    `before` is an expression, evaluated before the statement, and before each test of a loop's condition.
    `after` is a statement, or nothing, for after an expression; `inside` begins the body of every lambda.
    """

    before: Callable[[Statement], str]
    after: Callable[[Statement], str]
    inside: str


def marked(code: str, marks: Marks, *, are_declarations: bool = False) -> str | None:
    """The statements of a function body, or of functions among declarations, with their marks.

    None for code that does not parse. A `constexpr` function stays without marks.
    """
    before = _BEFORE_DECLARATIONS if are_declarations else _BEFORE
    root = tree_of(f"{before}{code}{_AFTER}")
    if root.has_error:
        return None
    text = (root.text or b"")[len(before) : -len(_AFTER)]
    marking = _Marking(code, marks)
    marking.mark(root)
    parts: list[bytes] = []
    position = 0
    for at, inserted in marking.in_order():
        offset = at - len(before)
        parts += [text[position:offset], inserted.encode()]
        position = offset
    return b"".join([*parts, text[position:]]).decode()


_BEFORE, _BEFORE_DECLARATIONS, _AFTER = "void f() {\n", "namespace f {\n", "\n}"
_FUNCTIONS = ("lambda_expression", "function_definition")
_LOOPS = ("while_statement", "do_statement", "for_statement", "for_range_loop")
_NO_STATEMENTS = ("comment", "case_statement", "else_clause")


class _Marking:
    """One walk over the tree of a function."""

    def __init__(self, code: str, marks: Marks) -> None:
        self._lines = code.split("\n")
        self._marks = marks
        self._starts: list[tuple[int, str]] = []
        self._ends: list[tuple[int, str]] = []

    def in_order(self) -> list[tuple[int, str]]:
        """Returns the insertions by byte of the tree's text; at one place an end comes before a start."""
        return sorted([*reversed(self._ends), *self._starts], key=lambda insertion: insertion[0])

    def mark(self, root: Node) -> None:
        # Nodes wait on a stack, so that no text is too deep to read.
        waiting = [(node, False) for node in root.children[0].children]
        while waiting:
            node, is_in_lambda = waiting.pop()
            if node.type == "function_definition" and _is_of_compile_time(node):
                continue
            is_body = node.type == "compound_statement" and _parent(node).type in _FUNCTIONS
            if is_body and _parent(_parent(node)).type != "translation_unit":
                is_in_lambda = True
                self._starts.append((node.start_byte + 1, f" {self._marks.inside} "))
            self._mark(node, is_in_lambda)
            waiting += [(child, is_in_lambda) for child in reversed(node.children)]

    def _mark(self, node: Node, is_in_lambda: bool) -> None:
        is_branch = _is_branch(node)
        if is_branch or _is_in_a_list(node):
            statement = self._statement(node)
            has_after = node.type == "expression_statement" and not is_in_lambda
            after = self._marks.after(statement) if has_after else ""
            self._starts.append((node.start_byte, f"{'{ ' * is_branch}{self._marks.before(statement)}; "))
            self._ends.append((node.end_byte, f"{' ' * bool(after)}{after}{' }' * is_branch}"))
        if node.type in _LOOPS:
            self._mark_condition(node)

    def _mark_condition(self, loop: Node) -> None:
        """A condition that is there and declares nothing; a `for` without one tests the mark."""
        mark = self._marks.before(self._statement(loop))
        condition = field_of(loop, "condition")
        if condition is None:
            if loop.type == "for_statement":
                last = [child for child in loop.children if child.type == ";"][-1]
                self._starts.append((last.start_byte, f"{mark}, true"))
            return
        if condition.type in ("condition_clause", "parenthesized_expression"):
            if condition.named_child_count != 1:
                return
            condition = condition.named_children[0]
        if "declaration" not in condition.type:
            self._starts.append((condition.start_byte, f"{mark}, "))

    def _statement(self, node: Node) -> Statement:
        line, byte = node.start_point
        before = self._lines[line - 1].encode()[:byte]
        return Statement(line, len(before.decode()) + 1, (node.text or b"").decode())


def _is_of_compile_time(function: Node) -> bool:
    return any((child.text or b"") in (b"constexpr", b"consteval") for child in function.children)


def _parent(node: Node) -> Node:
    assert node.parent is not None
    return node.parent


def _is_branch(node: Node) -> bool:
    """A statement without braces below an `if`, an `else` or a loop."""
    parent = _parent(node)
    if not node.is_named or node.type in ("compound_statement", *_NO_STATEMENTS):
        return False
    if parent.type == "else_clause":
        return True
    field = "consequence" if parent.type == "if_statement" else "body" if parent.type in _LOOPS else ""
    return bool(field) and node == field_of(parent, field)


def _is_in_a_list(node: Node) -> bool:
    """A statement among others, in braces or after a label of a `switch`."""
    parent = _parent(node)
    if not node.is_named or node.type in _NO_STATEMENTS:
        return False
    if parent.type == "case_statement":
        return node != field_of(parent, "value")
    return parent.type == "compound_statement"
