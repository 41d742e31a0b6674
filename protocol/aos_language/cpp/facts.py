"""The findings of a C++ snippet, as data; `snippets` fills them in."""

from collections.abc import Iterable, Iterator
from enum import StrEnum

import msgspec

from aos_language.cpp.tokens import Extent, Fault

CHANGING_METHODS = frozenset({
    "append", "assign", "clear", "emplace", "emplace_back", "emplace_front", "erase", "fill", "flip",
    "insert", "insert_or_assign", "merge", "pop", "pop_back", "pop_front", "push", "push_back", "push_front",
    "replace", "reserve", "resize", "swap", "try_emplace",
})  # fmt: skip
EXCHANGING_METHODS = frozenset({"merge", "swap"})
"""Those that change what they are given as well."""
HANDLE_METHODS = frozenset({
    "begin", "data", "end", "equal_range", "find", "lower_bound", "rbegin", "rend", "upper_bound",
})  # fmt: skip
READING_METHODS = frozenset({
    "at", "back", "c_str", "compare", "contains", "count", "empty", "front", "length", "rfind", "size", "str",
    "substr", "top",
})  # fmt: skip
READING_FUNCTIONS = frozenset({
    "abs", "acos", "asin", "atan", "atan2", "bool", "ceil", "clamp", "cos", "double", "exp", "exp2", "fabs",
    "float", "floor", "fmax", "fmin", "fmod", "hypot", "int", "isfinite", "isnan", "log", "log10", "log2",
    "lround", "make_pair", "make_tuple", "max", "min", "pow", "round", "sin", "sqrt", "static_cast", "string",
    "tan", "tanh", "to_string", "trunc",
})  # fmt: skip


class Access(StrEnum):
    """The effects that a mention can have. BIND makes a reference, a pointer or an iterator, through which
    it may change."""

    READ = "read"
    WRITE = "write"
    UPDATE = "update"
    BIND = "bind"
    CALL = "call"


class Mention(msgspec.Struct, frozen=True):
    """One use of a variable, as a whole access path.

    `state__.robot.at` is `("state__", "robot", "at")`, `->` counts as `.`, a subscript is `"[]"`, and
    `std::sort` is `("std", "sort")`. For a method call the path is the object's. `extent` covers the path,
    `root` its first name, `assigned` what an assignment assigns. Names in subscripts and arguments are
    mentions of their own.
    """

    path: tuple[str, ...]
    access: Access
    extent: Extent
    root: Extent
    method: str = ""
    assigned: Extent | None = None

    @property
    def text(self) -> str:
        return ".".join(self.path).replace(".[]", "[]")


class Element(msgspec.Struct, frozen=True):
    """An element that a container has to have: `row[i]`, or that of `row.back()` and its like.

    `brackets` are those of the index; None for a method. `root` is the name that the container begins with;
    empty where a container of the state has to be asked, too.
    """

    container: Extent
    brackets: Extent | None = None
    root: str = ""


class Call(msgspec.Struct, frozen=True):
    """A call: `AOS.Bernoulli(p)` is named `("AOS", "Bernoulli")`. `function` covers the name."""

    name: tuple[str, ...]
    extent: Extent
    function: Extent
    arguments: tuple[Extent, ...]


class DeclarationKind(StrEnum):
    VARIABLE = "variable"
    PARAMETER = "parameter"
    ENUM = "enum"
    ENUMERATOR = "enumerator"


class Declaration(msgspec.Struct, frozen=True):
    """A name that the snippet declares. `type` is as written; for an enumerator it is the enum's name."""

    name: str
    type: str
    kind: DeclarationKind
    extent: Extent
    initial: Extent | None = None


class OddPart(msgspec.Struct, frozen=True):
    """Code that does other than it seems to say, as `1/2`, where all names `of_enums` are values of enums.

    `local` is a variable of the code that no other snippet of its section may use for that.
    """

    extent: Extent
    message: str
    hint: str
    of_enums: tuple[str, ...]
    local: str = ""


class Cpp(msgspec.Struct, frozen=True):
    """A snippet as read; everything in text order.

    `idle_operators` are `==` of statements that only compare, the comma before a number that does nothing,
    as in `x = 1,5;`, and the `+` of `x =+ 1;`. `idle_values` are other statements that only have a value, as
    `x - 1;`. `set_in_conditions` are what conditions set, with the sign: `if (x = 1)`. `odd_parts` do
    other than they seem to say.
    """

    code: str
    mentions: tuple[Mention, ...] = ()
    calls: tuple[Call, ...] = ()
    elements: tuple[Element, ...] = ()
    declarations: tuple[Declaration, ...] = ()
    types: tuple[tuple[str, Extent], ...] = ()
    literals: tuple[Extent, ...] = ()
    missing_semicolons: tuple[int, ...] = ()
    faults: tuple[Fault, ...] = ()
    is_empty: bool = False
    idle_operators: tuple[Extent, ...] = ()
    idle_values: tuple[Extent, ...] = ()
    set_in_conditions: tuple[tuple[Extent, Extent], ...] = ()
    odd_parts: tuple[OddPart, ...] = ()

    @property
    def complete(self) -> str:
        """The code with the semicolons that it lacks."""
        return self.replace((offset, ";") for offset in self.missing_semicolons)

    @property
    def declared(self) -> frozenset[str]:
        """The names that the code declares."""
        return frozenset(declaration.name for declaration in self.declarations)

    def text(self, extent: Extent) -> str:
        return self.code[extent.start : extent.end]

    def writes(self) -> Iterator[Mention]:
        """The mentions through which something changes or may change."""
        changing = (Access.WRITE, Access.UPDATE, Access.BIND)
        return (mention for mention in self.mentions if mention.access in changing)

    def replace(self, edits: Iterable[tuple[Extent | int, str]]) -> str:
        """The code with pieces replaced; an offset in place of an extent inserts. ValueError on overlap."""
        pieces: list[str] = []
        position = 0
        spans = [((at, at) if isinstance(at, int) else (at.start, at.end), text) for at, text in edits]
        for (start, end), text in sorted(spans, key=lambda item: item[0]):
            if start < position:
                raise ValueError(f"two edits overlap at offset {start}")
            pieces += [self.code[position:start], text]
            position = end
        return "".join([*pieces, self.code[position:]])
