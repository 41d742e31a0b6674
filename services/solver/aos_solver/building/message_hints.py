"""The compiler's messages in the words of documents: their types, map variables, which messages know by the
class that holds them, and hints where another language's word or one sign in place of another stands."""

import re

_MEMBERS = {
    "add": "insert", "append": "push_back", "isEmpty": "empty", "is_empty": "empty", "items": "begin",
    "len": "size", "length": "size", "pop": "pop_back", "push": "push_back", "remove": "erase",
}  # fmt: skip
"""Members as other languages call them."""
_HINTS = (
    (
        re.compile(r"conversion from `(\w+)\*` to non-scalar type `\1` requested"),
        r"The list holds pointers: write `\1*`",
    ),
    (re.compile(r"base operand of `->` has non-pointer type `.*`"), "Write `.` in place of `->`"),
    (
        re.compile(r"return-statement with a value, in function returning `void`"),
        "Set `__meetPrecondition`, `__reward` or `__moduleResponse`, and write `return;`",
    ),
    (re.compile(r"`format` is not a member of `std`"), "Write `std::to_string`, and join texts with `+`"),
    (re.compile(r"invalid use of member function .*"), "It is called with brackets behind it: `(...)`"),
    (
        re.compile(r"expected primary-expression before `\.` token"),
        "A value of an enum is written by its name alone",
    ),
    (
        re.compile(r"cannot convert `std::string` to `int` in assignment"),
        "A response that is a text is given to `__moduleResponseStr`",
    ),
)
_NO_MEMBER = re.compile(r"`.*` has no member named `(\w+)`")


def hint_for(message: str) -> str:
    """The hint for a message in the documents' words; empty where none is known."""
    if (member := _NO_MEMBER.fullmatch(message)) is not None:
        return f"C++ writes `.{_MEMBERS[member[1]]}`" if member[1] in _MEMBERS else ""
    for pattern, hint in _HINTS:
        if (found := pattern.fullmatch(message)) is not None:
            return found.expand(hint)
    return ""


_MAP = re.compile(
    r"(?:const )?(?:class )?aos::Table<((?:[^<>]|<[^<>]*>)*?),\s*(aos::(?:Enum|Range)Axis<.*?>)\s*>"
)
_KEYS = re.compile(r"EnumAxis<(\w+), ?\d+>|RangeAxis<(-?\d+), ?(-?\d+), ?(-?\d+)>")
_VALUE = re.compile(r"no match for `operator=`")
_INDEX = re.compile(r"no match for `operator\[\]`|no viable overloaded operator\[\]")


def told_of_a_map(text: str) -> tuple[str, str] | None:
    """Returns the message in the documents' terms with its hint; None if it is about no map variable."""
    found = _MAP.search(text)
    if found is None:
        return None
    keys = ", ".join(_key(*parts) for parts in _KEYS.findall(found[2]))
    name = named[1] + named[2] if (named := STATE_PART.search(text)) else "state.NAME"
    hint = f"An element of it is `{name}[{{...}}]`, with a key for each of {{{keys}}}"
    if _VALUE.search(text):
        return "a map variable takes no value as a whole", hint
    if _INDEX.search(text):
        return f"the keys of this map variable are {{{keys}}}, and these are others", hint
    return _MAP.sub(f"map of {found[1]}", STATE_PART.sub(r"\1\2", text)), hint


def _key(enum: str, start: str, stop: str, step: str) -> str:
    return enum or f"({start},{stop},{step})"


_WORDS = (
    (re.compile(r"(?:const )?(?:class )?aos::Vector<(.+?), \d+>"), r"vector<\1>"),
    (re.compile(r"(?:const )?(?:class )?aos::Named<(\w+), \d+, ([^<>]+)>"), r"array of \2 over \1"),
    (re.compile(r"(?:const )?(?:class )?aos::Text\b"), "string"),
    (re.compile(r"(?:const )?(?:class )?aos::Map<vector<aos::Pair<(.+?)> ?> ?>"), r"map<\1>"),
    (re.compile(r"aos::Objects<\w+, (\w+)[^<>]*>"), r"list of \1"),
    (re.compile(r"std::(?:__cxx11::)?basic_string<char>"), "std::string"),
    (re.compile(r"`<brace-enclosed initializer list>`"), "a list in braces"),
    (re.compile(r"`const char ?(?:\*|\[\d+\])`"), "a text"),
)
STATE_PART = re.compile(r"\b(state_*\.)(?:\w+::|<anonymous>(?:::|\.))*(\w+)")
"""A variable of a state, behind the class that holds it."""
_ASSIGNED = re.compile(
    r"no match for `operator=` in .* \(operand types are (?P<to>.+?) and (?P<value>[^()]+)\)"
)
_PARAMETERS = re.compile(
    r"no matching function for call to `std::vector<std::tuple<(.*)> ?>::push_back\(std::tuple<(.*)>\)`"
)
_ARRAY = r"(?:const )?(?:array of |vector<)"
_CALLED = re.compile(rf"no match for call to `\({_ARRAY}|type `{_ARRAY}.*` does not provide a call operator")
_NUMBER_FOR_ENUM = re.compile(
    r"invalid conversion from `(?:int|long int)` to `(\w+)`"
    r"|(?:cannot initialize a (?:variable|parameter) of|assigning to) (?:type )?`(\w+)` "
    r"(?:with an? [lr]value of type|from incompatible type) `(?:int|long)`"
)
_OF_LIBRARY = re.compile(
    r",\s*std::(?:allocator|char_traits|equal_to|hash|less)<(?:[^<>]|<(?:[^<>]|<[^<>]*>)*>)*>(?:\s+(?=>))?"
)
"""Arguments of containers that no document writes."""
_RANGE = re.compile(
    r"no matching function for call to `(accumulate|(?:all|any|none)_of|binary_search|count(?:_if)?|fill"
    r"|find(?:_if)?|for_each|iota|(?:max|min|nth)_element|lower_bound|remove(?:_if)?|reverse|sort|unique"
    r"|upper_bound)"
    r"(?:\((?:const )?(?:(?:array|list) of |(?:std::)?(?:array|deque|list|map|set|string|vector)\b)"
    r".*\))?`"
)
_LIST_FOR_ONE = re.compile(
    r"cannot convert `<brace-enclosed initializer list>` to `(.+)` in (?:assignment|initialization)"
)
_OTHER_TYPES = re.compile(r"no matching function for call to `(max|min)\(([a-z ]+)&?, ([a-z ]+)&?\)`")
_NO_ARRAY = re.compile(r"invalid types `(.+)\[.*\]` for array subscript|subscripted value is n.*")
_NOT_CAPTURED = re.compile(r"`(\w+)` is not captured|variable `(\w+)` cannot be implicitly captured .*")
_NOT_ASSIGNED = "no viable overloaded `=`"
"""Clang's words, without the types."""


def in_words(text: str) -> tuple[str, str]:
    """Returns a message with our types by their names in documents, and a hint where one is known."""
    text = _OF_LIBRARY.sub("", STATE_PART.sub(r"\1\2", text))
    text = re.sub(r"`(?:class|struct) ", "`", re.sub(r"`[^`]*` \{aka (`[^`]*`)\}", r"\1", text))
    if (outer := _NOT_CAPTURED.fullmatch(text)) is not None:
        return f"`{outer[1] or outer[2]}` is not captured by this lambda", "Write `[&]` at its beginning"
    is_text = "`const char" in text
    plain = text
    for pattern, word in _WORDS:
        plain = pattern.sub(word, plain)
    if _CALLED.match(plain) is not None:
        return "this is an array, and no function", "An element of it has square brackets: `[i]`"
    if (other := _OTHER_TYPES.fullmatch(text)) is not None:
        message = f"`{other[1]}` compares values of one type, and these are {other[2]} and {other[3]}"
        return message, f"Write `std::{other[1]}<double>(...)`, or both with a point"
    if (one := _LIST_FOR_ONE.fullmatch(text)) is not None:
        return f"`{one[1]}` cannot be set to a list in braces", "Is it to be an array?"
    if _NO_ARRAY.fullmatch(text) is not None:
        return "this is one value, and has no elements", "Is it to be an array?"
    if (called := _RANGE.fullmatch(plain)) is not None:
        hint = f"Write `std::{called[1]}(values.begin(), values.end(), ...)`"
        return f"`{called[1]}` takes a beginning and an end, and no container", hint
    if plain == _NOT_ASSIGNED:
        return "this cannot be set to a value of that type", ""
    if (listed := _PARAMETERS.match(plain)) is not None:
        taken, given = listed[1].strip(), listed[2].strip()
        return (
            f"the parameters of this skill are ({taken}), and these values are ({given})",
            "Give `std::make_tuple` one value for each parameter, in their order",
        )
    if (enum := _NUMBER_FOR_ENUM.search(plain)) is not None:
        name = enum[1] or enum[2]
        hint = f"Write `({name})` before it; a draw is `AOS.SampleDiscrete({name}, {{...}})`"
        return f"a number is no value of {name}", hint
    if (refused := _ASSIGNED.fullmatch(plain)) is None:
        # Only a refused assignment has its literals put in words.
        for pattern, word in _WORDS[:-2]:
            text = pattern.sub(word, text)
        return text, ""
    hint = "Numbers, values of enums and responses are written without quotes" if is_text else ""
    return f"{refused['to']} cannot be set to {refused['value']}", hint
