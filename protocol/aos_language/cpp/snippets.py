"""The mentions, writes, calls and declarations in a C++ snippet of a document.

Reading is tolerant: whatever the text is, the answer is a `Cpp`, with faults where it does not parse. A
snippet with bracket, quote, comment or preprocessor faults could leave its function, so nothing else of it is
read, nor of one that takes the parser long. No names are resolved here: a mention is what is written.
"""

from collections.abc import Iterable
from functools import lru_cache

from msgspec.structs import replace

from aos_language.cpp.facts import Access, Call, Cpp, Declaration, DeclarationKind, Mention
from aos_language.cpp.reader import TreeReader
from aos_language.cpp.tokens import Extent, Fault, FaultKind, Tokens, cut
from aos_language.cpp.tree import tree_soon

__all__ = [
    "Access",
    "Call",
    "Cpp",
    "Declaration",
    "DeclarationKind",
    "Extent",
    "Fault",
    "FaultKind",
    "Mention",
    "blanked",
    "read_cpp",
    "read_cpp_declarations",
    "read_cpp_expression",
    "strip_comments",
]


def strip_comments(code: str) -> str:
    """The code with comments blanked, so that offsets and lines stay."""
    return blanked(code, cut(code).comments)


def blanked(code: str, extents: Iterable[Extent]) -> str:
    """The code with blanks in place of some of its parts; lines stay."""
    characters = list(code)
    for extent in extents:
        for index in range(extent.start, extent.end):
            if characters[index] != "\n":
                characters[index] = " "
    return "".join(characters)


@lru_cache(maxsize=4096)
def read_cpp(code: str) -> Cpp:
    """Statements, as they stand in a function body."""
    return _read(code, cut(code), before="void f() {", after="\n}")


@lru_cache(maxsize=4096)
def read_cpp_expression(code: str) -> Cpp:
    """One expression, or a list in braces that a variable starts with."""
    tokens = replace(cut(code), missing_semicolons=())
    is_list = strip_comments(code).lstrip().startswith("{")
    before, after = ("auto x = ", "\n;") if is_list else ("auto x = (", "\n);")
    return _read(code, tokens, before=before, after=after)


@lru_cache(maxsize=256)
def read_cpp_declarations(code: str) -> Cpp:
    """Declarations, as they stand in a namespace."""
    return _read(code, cut(code), before="", after="\n")


def _read(code: str, tokens: Tokens, *, before: str, after: str) -> Cpp:
    is_empty = not blanked(code, tokens.comments).strip()
    if tokens.faults or is_empty:
        return Cpp(code, literals=tokens.literals, faults=tokens.faults, is_empty=is_empty)
    complete = Cpp(code, missing_semicolons=tokens.missing_semicolons).complete
    root = tree_soon(before + complete + after)
    if root is None:
        whole = Extent(0, len(code))
        fault = Fault(FaultKind.SIZE, "this code takes too long to read", whole, "Write less of it, or C++")
        return Cpp(code, literals=tokens.literals, faults=(fault,))
    return TreeReader(code, complete, len(before), tokens).read(root)
