"""The operations of the API, as a table: each with its path, its types, and the function that does it.

Routes, checks of requests and the OpenAPI document are made from it, so that none of them can say something
else.
"""

import gzip
import inspect
from collections.abc import AsyncIterator, Awaitable, Callable
from http import HTTPStatus
from typing import Any, Literal, get_type_hints

import msgspec
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from aos_gateway.problems import PROBLEM_TYPE, problem_of
from aos_gateway.shared import Gateway
from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import AosError, GatewayError

JSON = "application/json"
EVENT_STREAM = "text/event-stream"
SVG = "image/svg+xml"
_COMPRESSED_FROM_BYTES = 1024
_LEVEL = 5


class _TooLargeError(GatewayError):
    """A body that is not read to its end."""


class Content(msgspec.Struct, frozen=True):
    """An answer that is no message: bytes of a media type. `max_age_s` is for what never changes."""

    data: bytes
    media: str
    max_age_s: int = 0


class Operation(msgspec.Struct, frozen=True, kw_only=True):
    """One operation. `do(gateway, **parameters)` has the path's parameters as text, those of the `query` as a
    structure, and the `body` as a structure or, of `uploads`, as bytes."""

    method: Literal["GET", "POST", "DELETE"]
    path: str
    do: Callable[..., Awaitable[Any]]
    gives: Any
    media: str = JSON
    status: int = 200
    query: type[msgspec.Struct] | None = None
    body: type[msgspec.Struct] | None = None
    upload: str = ""

    @property
    def name(self) -> str:
        """The name in the OpenAPI document."""
        return getattr(self.do, "__name__", "")

    @property
    def summary(self) -> str:
        """The first sentence of the function's docstring."""
        return " ".join((inspect.getdoc(self.do) or "").split("\n\n")[0].split())


def operation(
    method: Literal["GET", "POST", "DELETE"], path: str, do: Callable[..., Awaitable[Any]], **more: Any
) -> Operation:
    """The operation of a function, whose annotations give the types of query, body and answer."""
    hints = get_type_hints(do)
    gives = more.pop("gives", hints.get("return"))
    return Operation(
        method=method,
        path=path,
        do=do,
        gives=gives,
        query=hints.get("query"),
        body=hints["body"] if hints.get("body") not in (None, bytes) else None,
        **more,
    )


def route_of(one: Operation, gateway: Gateway) -> Route:
    """The route that checks a request, does the operation, and encodes what it gives."""

    async def answer(request: Request) -> Response:
        try:
            given: dict[str, Any] = dict(request.path_params)
            if "mission" in given:
                given["mission"] = await gateway.shelf.named(given["mission"])
            if one.query is not None:
                given["query"] = _structure(dict(request.query_params), one.query)
            if one.body is not None:
                given["body"] = _decoded(await _body(request, gateway.max_body_bytes), one.body)
            elif one.upload:
                given["body"] = await _body(request, gateway.max_body_bytes)
            if one.media == EVENT_STREAM:
                given["last_event_id"] = request.headers.get("last-event-id", "")
            result = await one.do(gateway, **given)
        except _TooLargeError as error:
            return response_of(error, status=HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
        except AosError as error:
            return response_of(error)
        return _response(result, one, accepts_gzip="gzip" in request.headers.get("accept-encoding", ""))

    return Route(one.path, answer, methods=[one.method], name=one.name)


def response_of(error: AosError, **more: Any) -> Response:
    """The error as problem details."""
    problem = problem_of(error, **more)
    headers = {"www-authenticate": "Bearer"} if problem.status == HTTPStatus.UNAUTHORIZED else None
    return Response(msgspec.json.encode(problem), problem.status, headers, PROBLEM_TYPE)


def _response(result: Any, one: Operation, *, accepts_gzip: bool) -> Response:
    headers = {"cache-control": "no-store", "x-content-type-options": "nosniff"}
    if isinstance(result, AsyncIterator):
        headers["x-accel-buffering"] = "no"
        return StreamingResponse(result, one.status, headers, one.media)
    if isinstance(result, Content):
        if result.max_age_s:
            headers["cache-control"] = f"private, max-age={result.max_age_s}"
        data, media = result.data, result.media
        if media == SVG:
            # A picture of documents is opened as a page, too: it must not speak for the gateway there.
            headers["content-security-policy"] = "default-src 'none'; style-src 'unsafe-inline'; sandbox"
    else:
        data, media = msgspec.json.encode(result), one.media
    if accepts_gzip and len(data) >= _COMPRESSED_FROM_BYTES and not media.startswith("image/"):
        data = gzip.compress(data, _LEVEL, mtime=0)
        headers |= {"content-encoding": "gzip", "vary": "accept-encoding"}
    return Response(data, one.status, headers, media)


async def _body(request: Request, max_bytes: int) -> bytes:
    parts, size = [], 0
    try:
        async for part in request.stream():
            size += len(part)
            if size > max_bytes:
                raise _TooLargeError(f"the body has more than {max_bytes} bytes", code="AOS901")
            parts.append(part)
    except ClientDisconnect as error:
        raise GatewayError("the body has no end", code="AOS901") from error
    return b"".join(parts)


def _decoded(data: bytes, kind: type[msgspec.Struct]) -> Any:
    try:
        return msgspec.json.decode(data or b"{}", type=kind)
    except UNREADABLE as error:
        raise GatewayError(f"the body is wrong: {error}", code="AOS901") from error


def _structure(given: dict[str, str], kind: type[msgspec.Struct]) -> Any:
    unknown = given.keys() - {field.name for field in msgspec.structs.fields(kind)}
    if unknown:
        raise GatewayError(f"unknown parameter {sorted(unknown)[0]}", code="AOS901")
    try:
        return msgspec.convert(given, kind, strict=False)
    except UNREADABLE as error:
        raise GatewayError(f"the parameters are wrong: {error}", code="AOS901") from error
