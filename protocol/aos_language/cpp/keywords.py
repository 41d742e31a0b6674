"""The words of C++20 and of model code that can name nothing else."""

import re

CPP_KEYWORDS = frozenset({
    "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch",
    "char", "char16_t", "char32_t", "char8_t", "class", "co_await", "co_return", "co_yield", "compl",
    "concept", "const", "const_cast", "consteval", "constexpr", "constinit", "continue", "decltype",
    "default", "delete", "do", "double", "dynamic_cast", "else", "enum", "explicit", "export", "extern",
    "false", "float", "for", "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new",
    "noexcept", "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private", "protected", "public",
    "register", "reinterpret_cast", "requires", "return", "short", "signed", "sizeof", "static",
    "static_assert", "static_cast", "struct", "switch", "template", "this", "thread_local", "throw", "true",
    "try", "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual", "void", "volatile",
    "wchar_t", "while", "xor", "xor_eq",
})  # fmt: skip

DRAW_SOURCES = frozenset({"AOS", "AOSUtils"})
"""The objects of model code that draw."""

STATES = ("state", "state_", "state__", "state___")
"""The copies of the state that model code sees; `state.x` and `state__.x` are one variable."""

OUR_NAMES = frozenset({"NULL", *DRAW_SOURCES, *STATES})
"""Names that model code has without a declaration."""

SPECIAL_NAMES = frozenset({
    "__heuristicValue", "__isFailureState", "__isGoalState", "__meetPrecondition", "__moduleExecutionTime",
    "__moduleResponse", "__moduleResponseStr", "__observed", "__possibleParameters", "__reward",
    "__stopEvaluatingState",
})  # fmt: skip
"""Sections of model code read and set these names."""

COMPILER_NAMES = re.compile(r"__[a-zA-Z]+__|__(builtin|func|int|attribute|asm|restrict|typeof)\w*")
"""Names that compilers give a meaning."""
