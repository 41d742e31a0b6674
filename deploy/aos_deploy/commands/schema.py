"""`aos schema`: JSON Schemas for editors.

Those of the dialects are from `aos_language`, the deploy file's follows from the types that read it.
"""

import json
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Annotated, Any

import msgspec
import typer

from aos_deploy.deployment.parts import DeployFile
from aos_deploy.options import command
from aos_language.schemas.documents import gsdl_schema, plp_schema


class Name(StrEnum):
    PLP = "plp"
    GSDL = "gsdl"
    DEPLOY = "deploy"


@command("Example: aos schema deploy > deploy.schema.json")
def schema(
    name: Annotated[
        Name, typer.Argument(help="plp: JSON of AOS 1.x, gsdl: the paper's JSON, deploy: the deploy file")
    ],
) -> None:
    """Print a JSON Schema for editors.

    How an editor uses it: docs/editors.md in the sources of AOS.
    """
    typer.echo(json.dumps(SCHEMAS[name](), indent=2))


def _deploy_schema() -> dict[str, Any]:
    """A JSON Schema (draft 2020-12) for the YAML file that aos-up takes."""
    # Through JSON, for the defaults that are tuples.
    schema: dict[str, Any] = json.loads(json.dumps(msgspec.json.schema(DeployFile)))
    parts = schema["$defs"]
    for part in parts.values():
        part["additionalProperties"] = False
        part["description"] = " ".join(part["description"].split())
    parts["SolverPart"]["not"] = {"required": ["simulations", "time_s"]}
    parts["DeployFile"]["properties"]["bundles"]["minItems"] = 1
    parts["ProgramPart"]["properties"]["command"]["minItems"] = 1
    kinds = ("port", "line", "file", "command", "seconds", "exit")
    parts["ReadyPart"]["oneOf"] = [{"required": [kind]} for kind in kinds]
    properties = parts["DeployFile"]["properties"]
    expressions = {"type": "object", "additionalProperties": {"type": ["string", "number", "boolean"]}}
    bound = {
        "type": "object",
        "minProperties": 1,
        "properties": {"fields": expressions, "result": expressions},
    }
    properties["bind"]["additionalProperties"] = {"anyOf": [{"type": "string"}, bound]}
    adapter = {"anyOf": [{"type": "string"}, {"type": "object", "minProperties": 1}]}
    properties["adapters"]["additionalProperties"] = adapter
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "AOS deploy file"}
    return {**head, **schema}


SCHEMAS: Mapping[str, Callable[[], dict[str, Any]]] = {
    "plp": plp_schema,
    "gsdl": gsdl_schema,
    "deploy": _deploy_schema,
}
"""The schemas by name: AOS 1.x JSON (`PlpMain`), the paper's JSON (`GsdlMain`), the deploy file."""
