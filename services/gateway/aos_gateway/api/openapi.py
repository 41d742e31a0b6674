"""The OpenAPI document, made from the table of operations and the message types."""

import re
from collections.abc import Iterable
from typing import Any

import msgspec

from aos_gateway.operations import JSON, Operation
from aos_gateway.problems import PROBLEM_TYPE, Problem
from aos_protocol import __version__

_REFERENCES = "#/components/schemas/{name}"
_NAME = {"type": "string", "minLength": 1}
_NUMBER = {"type": "integer", "minimum": 0}
_PARAMETER = re.compile(r"\{(\w+)\}")


def openapi_document(operations: Iterable[Operation]) -> dict[str, Any]:
    """The document, as plain data."""
    operations = tuple(operations)
    types = [
        Problem,
        *(kind for one in operations for kind in (one.gives, one.body, one.query) if _is_message(kind)),
    ]
    schemas, components = msgspec.json.schema_components(types, ref_template=_REFERENCES)
    schema_of = dict(zip(types, schemas, strict=True))
    paths: dict[str, dict[str, Any]] = {}
    for one in operations:
        paths.setdefault(one.path, {})[one.method.lower()] = _operation(one, schema_of, components)
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "AOS gateway",
            "version": __version__,
            "summary": "Runs, missions and decisions of AOS, and what an operator can do about them.",
            "license": {"name": "Apache-2.0", "identifier": "Apache-2.0"},
        },
        "paths": paths,
        "components": {
            "schemas": components,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }


def _is_message(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, msgspec.Struct) and kind.__name__ != "Content"


def _operation(one: Operation, schema_of: dict[Any, Any], components: dict[str, Any]) -> dict[str, Any]:
    schema = schema_of[one.gives] if _is_message(one.gives) else {"type": "string"}
    described: dict[str, Any] = {
        "operationId": one.name,
        "summary": one.summary,
        "tags": [one.path.split("/")[2] if one.path.count("/") > 1 else "gateway"],
        "parameters": [*_path_parameters(one.path), *_query_parameters(one.query, components)],
        "responses": {
            str(one.status): {"description": "Success", "content": {one.media: {"schema": schema}}},
            "default": {
                "description": "A problem",
                "content": {PROBLEM_TYPE: {"schema": schema_of[Problem]}},
            },
        },
    }
    if one.method != "GET":
        described["security"] = [{"token": []}]
    if one.body is not None:
        described["requestBody"] = {"required": True, "content": {JSON: {"schema": schema_of[one.body]}}}
    elif one.upload:
        binary = {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}
        described["requestBody"] = {"required": True, "description": one.upload, "content": binary}
    return described


def _path_parameters(path: str) -> list[dict[str, Any]]:
    return [
        {"name": name, "in": "path", "required": True, "schema": _NUMBER if name == "step" else _NAME}
        for name in _PARAMETER.findall(path)
    ]


def _query_parameters(kind: type | None, components: dict[str, Any]) -> list[dict[str, Any]]:
    if kind is None:
        return []
    schema = components[kind.__name__]
    return [
        {"name": name, "in": "query", "required": name in schema.get("required", ()), "schema": each}
        for name, each in schema["properties"].items()
    ]
