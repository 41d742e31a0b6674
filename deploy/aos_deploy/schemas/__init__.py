"""JSON Schemas for the JSON dialects and for the deploy file, for editors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from aos_deploy.schemas.deploy import deploy_schema
from aos_deploy.schemas.documents import gsdl_schema, plp_schema

__all__ = ["SCHEMAS"]

SCHEMAS: Mapping[str, Callable[[], dict[str, Any]]] = {
    "plp": plp_schema,
    "gsdl": gsdl_schema,
    "deploy": deploy_schema,
}
"""By name: AOS 1.x JSON (`PlpMain`), the paper's JSON (`GsdlMain`), the deploy file."""
