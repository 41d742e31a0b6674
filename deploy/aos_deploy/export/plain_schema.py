"""JSON schemas of messages as viewers of MCAP files understand them: whole in themselves, of single types."""

from typing import Any

import msgspec


def plain_schema(kind: type[Any]) -> dict[str, Any]:
    """The schema of a message, without references and without alternatives.

    What may be null is not required: `without_nulls` leaves it out. What may be of several types has none.
    """
    whole = msgspec.json.schema(kind)
    definitions = whole.get("$defs", {})
    return {"title": kind.__name__, **_plain(whole, definitions)}


def without_nulls(value: Any) -> Any:
    """JSON data whose objects lack the fields that are null."""
    if isinstance(value, dict):
        return {key: without_nulls(item) for key, item in value.items() if item is not None}
    if isinstance(value, list):
        return [without_nulls(item) for item in value]
    return value


def _plain(schema: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in schema:
        return _plain(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    if "anyOf" in schema:
        options = [option for option in schema["anyOf"] if option.get("type") != "null"]
        return _plain(options[0], definitions) if len(options) == 1 else {}
    kind = schema.get("type")
    if isinstance(kind, list):
        kinds = [each for each in kind if each != "null"]
        return {"type": kinds[0]} if len(kinds) == 1 else {}
    if kind == "object" and "properties" in schema:
        required = [
            name for name in schema.get("required", ()) if not _may_be_null(schema["properties"][name])
        ]
        properties = {name: _plain(each, definitions) for name, each in schema["properties"].items()}
        return {"type": "object", "properties": properties, **({"required": required} if required else {})}
    if kind == "array" and isinstance(schema.get("items"), dict):
        return {"type": "array", "items": _plain(schema["items"], definitions)}
    if "enum" in schema:
        return {"type": "string"}
    return {"type": kind} if kind else {}


def _may_be_null(schema: dict[str, Any]) -> bool:
    return schema.get("type") == "null" or any(_may_be_null(option) for option in schema.get("anyOf", ()))
