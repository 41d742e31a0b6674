"""`aos schema`: JSON Schemas for editors."""

import json
from enum import StrEnum
from typing import Annotated

import typer

from aos_deploy.deployment.schemas import SCHEMAS
from aos_deploy.marked_commands import command


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
