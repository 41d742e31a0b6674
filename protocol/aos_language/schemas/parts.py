"""The parts that the schemas of the JSON documents are put together from."""

from typing import Any

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
TRUTH: Schema = {"type": "boolean"}
NUMBER: Schema = {"type": "number"}
CODE: Schema = {"$ref": "#/$defs/code"}
BLOCK: Schema = {"$ref": "#/$defs/block"}
IMPORTS: Schema = {"$ref": "#/$defs/imports"}


def shared_parts() -> dict[str, Schema]:
    """Returns the definitions that several documents use."""
    loop = object_of(
        "Repeats for each state variable of a compound type.",
        Type=TEXT,
        ItemName=TEXT,
        ConditionCode=said(expression(), "For which items the code runs."),
        WhenConditionTrueCode=said(CODE, "The code that runs for each item."),
        Comment=TEXT,
        required=("Type", "ItemName"),
    )
    temporary = object_of(
        "A variable of the block.",
        VarName=TEXT,
        Type=TEXT,
        EnumName=said(TEXT, "For the type `enum`: its name."),
        EnumValues=said(list_of(TEXT), "For the type `enum`: its values."),
        Comment=TEXT,
        required=("VarName", "Type"),
    )
    assignment = object_of(
        "One assignment: temporary variable, loops, code, in this order.",
        AssignmentName=TEXT,
        TempVar=temporary,
        IteratePreviousStateVars=said(list_of(loop), "Loops over `state`."),
        IterateNextStateVars=said(list_of(loop), "Loops over the copy that the block writes."),
        AssignmentCode=CODE,
        Comment=TEXT,
    )
    imported = object_of("Names for the expressions.", From=TEXT, Import=list_of(TEXT), required=("Import",))
    return {
        "code": said({"anyOf": [TEXT, list_of(TEXT)]}, "Code: one text, or a list of lines."),
        "block": list_of(assignment),
        "imports": list_of(imported),
    }


def object_of(description: str, required: tuple[str, ...] = (), **properties: Schema) -> Schema:
    """An object with these keys and no others."""
    schema: Schema = {
        "description": description,
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }
    return {**schema, "required": list(required)} if required else schema


def list_of(items: Schema) -> Schema:
    return {"type": "array", "items": items}


def expression() -> Schema:
    """An expression; the readers take numbers and truth values for themselves."""
    return {"anyOf": [{"type": ["string", "number", "boolean"]}, list_of(TEXT)]}


def said(schema: Schema, description: str) -> Schema:
    """A schema with what editors show about it."""
    return {**schema, "description": description}
