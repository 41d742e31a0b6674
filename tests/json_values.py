"""The values that the JSON reader has read, as Python's own."""

from typing import Any

from aos_language.reading.json_text import (
    JsonArray,
    JsonConstant,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
)


def plain(value: JsonValue | None) -> Any:
    """Returns what `json.loads` would give; None also where nothing could be read."""
    match value:
        case JsonObject():
            return {key.text: plain(item) for key, item in value.members}
        case JsonArray():
            return [plain(item) for item in value.items]
        case JsonString():
            return value.text
        case JsonNumber() | JsonConstant():
            return value.value
    return None
