"""References and pointers of code: the parts of a state that they stand for, and code where some are null."""

import re
from collections import Counter
from collections.abc import Collection, Iterator

from tree_sitter import Node

from aos_language.cpp.facts import Access, Cpp, Declaration, Mention
from aos_language.cpp.keywords import STATES
from aos_language.cpp.tree import below, child_of, field_of, operator_of, text_of, tree_of

_BEFORE = "void f() {"
_NULLS = ("NULL", "nullptr", "0")
_LEAVING = {"return_statement", "continue_statement", "break_statement"}
_EFFECTS = ("call_expression", "assignment_expression", "update_expression")


def without_null(code: str, null: Collection[str]) -> str:
    """Blanks what never runs where the names `null` are null pointers; all places stay."""
    if not any(name in code for name in null):
        return code
    data = (_BEFORE + code + "\n}").encode("utf-8", "replace")
    waiting, cuts = [tree_of(data.decode())], list[tuple[int, int, str]]()
    while waiting:
        node = waiting.pop()
        dead = tuple(_never_run(node, null))
        cuts += dead
        waiting += [
            part
            for part in node.children
            if not any(start <= part.start_byte and part.end_byte <= end for start, end, _ in dead)
        ]
    for start, end, instead in sorted(cuts, reverse=True):
        blank = re.sub(r"[^\n]", " ", data[start:end].decode())
        data = data[:start] + (instead + blank[len(instead) :]).encode() + data[end:]
    return data.decode()[len(_BEFORE) : -2]


def _never_run(node: Node, null: Collection[str]) -> Iterator[tuple[int, int, str]]:
    """The bytes below a node that never run, with what stands in their place."""
    match node.type:
        case "compound_statement":
            for part in node.named_children[:-1]:
                if part.type == "if_statement" and _truth(child_of(part, "condition"), null):
                    body = child_of(part, "consequence")
                    if _LEAVING & {body.type, *(each.type for each in body.named_children[-1:])}:
                        yield part.end_byte, node.end_byte - 1, ""
                        return
        case "if_statement":
            truth = _truth(child_of(node, "condition"), null)
            body, otherwise = child_of(node, "consequence"), field_of(node, "alternative")
            if truth is False:
                yield body.start_byte, body.end_byte, ";"
            elif truth and otherwise is not None:
                yield otherwise.start_byte, otherwise.end_byte, ""
        case "conditional_expression":
            condition, then = child_of(node, "condition"), child_of(node, "consequence")
            otherwise, truth = child_of(node, "alternative"), _truth(condition, null)
            if truth is None or any(part.type in _EFFECTS for part in below(condition)):
                return
            if truth:
                yield condition.start_byte, then.start_byte, ""
                yield then.end_byte, otherwise.end_byte, ""
            else:
                yield condition.start_byte, otherwise.start_byte, ""
        case "binary_expression":
            right = child_of(node, "right")
            settled = {"&&": False, "||": True}.get(operator_of(node))
            if settled is not None and _truth(child_of(node, "left"), null) is settled:
                yield right.start_byte, right.end_byte, "0"


def _truth(node: Node, null: Collection[str]) -> bool | None:
    """Returns whether a condition holds; None where it depends on more than the null pointers."""
    match node.type:
        case "condition_clause" | "parenthesized_expression" if len(node.named_children) == 1:
            return _truth(node.named_children[0], null)
        case "identifier" if text_of(node) in null:
            return False
        case "unary_expression" if operator_of(node) == "!":
            inner = _truth(child_of(node, "argument"), null)
            return None if inner is None else not inner
        case "binary_expression":
            left, right = child_of(node, "left"), child_of(node, "right")
            operator = operator_of(node)
            if operator in ("==", "!="):
                sides = {text_of(left), text_of(right)}
                is_known = len(sides & set(_NULLS)) == 1 and len(sides & set(null)) == 1
                return operator == "==" if is_known else None
            settled = {"&&": False, "||": True}.get(operator)
            if settled is not None:
                truths = {_truth(left, null), _truth(right, null)}
                return settled if settled in truths else None if None in truths else not settled
    return None


_LOOP_COLON = re.compile(r"\s*:\s*")


def path_bound(cpp: Cpp, declaration: Declaration) -> tuple[str, ...]:
    """Returns the path of the state that a reference or pointer is bound to, also in a loop; else nothing."""
    initial = declaration.initial
    loop = _LOOP_COLON.match(cpp.code, declaration.extent.end) if initial is None else None
    start = initial.start if initial is not None else loop.end() if loop is not None else None
    if start is not None and initial is not None and declaration.type.endswith("*"):
        start = start + 1 if cpp.code.startswith("&", start) else None
    begun = (m for m in cpp.mentions if m.extent.start == start and m.path[0] in STATES and not m.method)
    return next((m.path for m in begun if initial is None or m.extent.end == initial.end), ())


def bound_paths(cpp: Cpp) -> dict[str, tuple[str, ...]]:
    """Returns what each reference or pointer stands for that is declared once and is not const."""
    names = Counter(declaration.name for declaration in cpp.declarations)
    return {
        place.name: path
        for place in cpp.declarations
        if names[place.name] == 1 and re.fullmatch(r"(?!const).*[&*]", place.type)
        if (path := path_bound(cpp, place))
    }


def changes_bound(cpp: Cpp, mention: Mention) -> bool:
    """Returns whether a mention of such a name changes what it stands for, and not only a pointer."""
    if mention.access not in (Access.WRITE, Access.UPDATE):
        return False
    own = next(each for each in cpp.declarations if each.name == mention.path[0])
    if own.type.endswith("&"):
        return True
    is_moved = any(m.path == (own.name,) and m.access is not Access.READ for m in cpp.mentions)
    return len(mention.path) > 1 and not is_moved
