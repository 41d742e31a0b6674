from typing import Any

from aos_language.reading import json_text


def plain(value: json_text.JsonValue | None) -> Any:
    """Returns what `json.loads` would give; None also where nothing could be read."""
    match value:
        case json_text.JsonObject():
            return {key.text: plain(item) for key, item in value.members}
        case json_text.JsonArray():
            return [plain(item) for item in value.items]
        case json_text.JsonString():
            return value.text
        case json_text.JsonNumber() | json_text.JsonConstant():
            return value.value
    return None
