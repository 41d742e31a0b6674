"""The texts of types, taken apart."""

import re

OVER_ENUM = re.compile(r"(.+)\[([A-Za-z_]\w*)\]")
ARRAY = re.compile(r"array<(.+),\s*(\w+)\s*>")
SORTED = re.compile(r"(pair(?=<.+,)|(?:unordered_)?(?:map(?=<.+,)|set))<(.+)>")


def normal_type(text: str) -> str:
    """The type without `std::` and without blanks that mean nothing."""
    text = " ".join(text.replace("std::", "").split())
    return re.sub(r"\s*([<>,\[\]])\s*", r"\1", text)


def arguments(text: str) -> list[str]:
    """The arguments of a template, which are divided by commas outside inner brackets."""
    parts, depth = [""], 0
    for character in text:
        depth += (character == "<") - (character == ">")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def element_type(text: str) -> str | None:
    """The element type of `T[]` and `vector<T>`; None for other types."""
    if text.endswith("[]"):
        return text[:-2]
    if text.startswith("vector<") and text.endswith(">"):
        return text[len("vector<") : -1]
    return None


def indexed_type(text: str) -> str:
    """The type of what stands at an index, or behind the key of a map; nothing for other types."""
    if (inner := element_type(text)) is not None:
        return inner
    if (fixed := ARRAY.fullmatch(text) or OVER_ENUM.fullmatch(text)) is not None:
        return fixed[1]
    listed = SORTED.fullmatch(text)
    return "" if listed is None else arguments(listed[2])[-1]
