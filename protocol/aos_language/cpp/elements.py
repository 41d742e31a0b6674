"""Expressions of C++ that a container has to have an element for: `row[i]`, `row.back()`, `*row.begin()`."""

from tree_sitter import Node

from aos_language.cpp.tree import child_of, field_of, names_of, text_of

_OF_FILLED = frozenset({"back", "front", "pop", "pop_back", "pop_front", "top"})
_BEGINNINGS = frozenset({"begin", "cbegin", "crbegin", "rbegin"})
_EXTREMES = frozenset({"max_element", "min_element"})


def is_checked(subscript: Node, indices: Node) -> bool:
    """Returns whether an index must be that of an element: not a key `{1, 2}`, nor `&row[9]`, where one may
    stand just behind the last."""
    outer = subscript.parent
    is_address = outer is not None and outer.type == "pointer_expression" and outer.children[0].type == "&"
    is_one = [part.type for part in indices.named_children if part.type != "comment"]
    return not is_address and len(is_one) == 1 and is_one[0] not in ("initializer_list", "comma_expression")


def asks_for_element(function: Node) -> bool:
    """Returns whether a method that is called needs an element, as `row.back` does."""
    return _is_one_of(function, _OF_FILLED)


def begun_container(iterator: Node) -> Node | None:
    """The container with a name that needs an element for an iterator to be read: `row` of `row.begin()`, and
    of `max_element(row.begin(), row.end())`."""
    if iterator.type != "call_expression":
        return None
    function = child_of(iterator, "function")
    if function.type == "field_expression":
        return _named(child_of(function, "argument")) if _is_one_of(function, _BEGINNINGS) else None
    names = names_of(function)
    first = next(iter(child_of(iterator, "arguments").named_children), None)
    if first is None or _EXTREMES.isdisjoint(names[-1:]):
        return None
    return _named(first) if "ranges" in names else begun_container(first)


def root_of(container: Node) -> Node:
    """The beginning of a container's path: `row` of `row[1].parts`."""
    while container.type in ("field_expression", "subscript_expression"):
        container = child_of(container, "argument")
    return container


def _named(container: Node) -> Node | None:
    return container if root_of(container).type == "identifier" else None


def _is_one_of(function: Node, methods: frozenset[str]) -> bool:
    method = names_of(field_of(function, "field"))[-1:]
    return not methods.isdisjoint(method) and text_of(function.children[1]) == "."
