"""The gateway as an ASGI application: access first, then the operations, then the page."""

from collections.abc import Awaitable, Callable
from http import HTTPStatus

import msgspec
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Match, Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from aos_gateway.api.access import COOKIE, Access
from aos_gateway.api.openapi import openapi_document
from aos_gateway.api.page import page_routes
from aos_gateway.metrics.exposition import EXPOSITION
from aos_gateway.operations import EVENT_STREAM, JSON, Content, Operation, operation, response_of, route_of
from aos_gateway.resources import documents, reading, run_files, study, writing
from aos_gateway.resources.state_picture import state_picture
from aos_gateway.shared import Gateway
from aos_protocol.errors import AosError, BusError, GatewayError

_HEADERS = {
    "content-security-policy": "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}

_METRICS = "/metrics"
"""The place at which Prometheus looks."""
_COOKIE_S = 400 * 86400
"""Browsers keep a cookie no longer. The page keeps the token for ever."""


def make_app(gateway: Gateway, access: Access) -> ASGIApp:
    """The application. Every request passes `access`."""
    described = Content(msgspec.json.encode(openapi_document(OPERATIONS)), JSON)

    async def openapi(gateway: Gateway) -> Content:
        """The description of all operations, as OpenAPI 3.1."""
        return described

    own = Operation(method="GET", path="/v1/openapi.json", do=openapi, gives=Content)
    routes = [route_of(one, gateway) for one in (own, *OPERATIONS)]
    if gateway.metrics is not None:
        routes.append(route_of(Operation(method="GET", path=_METRICS, do=_metrics, gives=Content), gateway))
    session = Route("/v1/session", _session_of(access), methods=["POST"])
    app = Starlette(
        routes=[session, *routes, *page_routes()],
        exception_handlers={HTTPException: _no_operation, Exception: _defect},
    )
    return _Guarded(app, access)


class _Guarded:
    """Refuses what `access` refuses, and adds the headers that keep a page to itself."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return
        request = Request(scope)

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = message.setdefault("headers", [])
                present = {name for name, _ in headers}
                headers += [
                    (name.encode(), text.encode())
                    for name, text in _HEADERS.items()
                    if name.encode() not in present
                ]
            await send(message)

        is_of_page = not scope["path"].startswith(("/v1", _METRICS))
        try:
            self._access.check(scope["method"], request.headers, request.cookies, is_open=is_of_page)
        except AosError as error:
            await response_of(error)(scope, receive, send_with_headers)
            return
        await self._app(scope, receive, send_with_headers)


async def _metrics(gateway: Gateway) -> Content:
    """The metrics of missions, for Prometheus."""
    assert gateway.metrics is not None
    return Content(await gateway.metrics.text(), EXPOSITION)


def _session_of(access: Access) -> Callable[[Request], Awaitable[Response]]:
    async def session(request: Request) -> Response:
        """Gives a browser that shows the token the cookie by which it may read."""
        response = Response(status_code=HTTPStatus.NO_CONTENT)
        response.set_cookie(COOKIE, access.token, max_age=_COOKIE_S, httponly=True, samesite="strict")
        return response

    return session


async def _no_operation(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    status = HTTPStatus(error.status_code)
    if status == HTTPStatus.NOT_FOUND:
        hint = "Metrics are off: `aos serve --metrics`" if request.url.path == _METRICS else ""
        return response_of(GatewayError(f"there is nothing at {request.url.path}", hint=hint))
    if status == HTTPStatus.METHOD_NOT_ALLOWED:
        allowed = ", ".join(_methods_at(request))
        text = f"there is no {request.method} of {request.url.path}"
        response = response_of(GatewayError(text, code="AOS901", hint=f"It has {allowed}"), status=status)
        response.headers["allow"] = allowed
        return response
    text = f"{request.method} {request.url.path}: {error.detail}"
    return response_of(GatewayError(text, code="AOS901"), status=status)


def _methods_at(request: Request) -> list[str]:
    """The methods of all routes to the request's path."""
    routes = [route for route in request.app.routes if isinstance(route, Route)]
    there = (route for route in routes if route.matches(request.scope)[0] is not Match.NONE)
    return sorted({method for route in there for method in route.methods or ()})


async def _defect(request: Request, error: Exception) -> Response:
    text = f"the gateway failed on {request.url.path}: {type(error).__name__}: {error}"
    return response_of(BusError(text, code="AOS606", hint="The gateway's terminal has the rest"))


_ARCHIVE = "an archive of documents, or one document"

OPERATIONS: tuple[Operation, ...] = (
    operation("GET", "/v1", reading.index),
    operation("GET", "/v1/projects", writing.projects),
    operation("POST", "/v1/projects", writing.upload, upload=_ARCHIVE, status=201),
    operation("POST", "/v1/checks", writing.check, upload=_ARCHIVE),
    operation("GET", "/v1/runs", reading.runs),
    operation("POST", "/v1/runs", writing.start, status=201),
    operation("GET", "/v1/runs/{run}", reading.run),
    operation("GET", "/v1/runs/{run}/services", run_files.services),
    operation("GET", "/v1/runs/{run}/logs/{service}", run_files.log, media="text/plain"),
    operation("GET", "/v1/runs/{run}/bundles", documents.bundles),
    operation("POST", "/v1/runs/{run}/bundles", writing.push, upload=_ARCHIVE),
    operation("POST", "/v1/runs/{run}/stop", writing.end),
    operation("POST", "/v1/runs/{run}/missions", writing.start_next, status=201),
    operation("GET", "/v1/missions", reading.missions),
    operation("GET", "/v1/missions/{mission}", reading.mission),
    operation("POST", "/v1/missions/{mission}/stop", writing.stop),
    operation("POST", "/v1/missions/{mission}/steering", writing.steer),
    operation("GET", "/v1/missions/{mission}/trace", reading.trace),
    operation("GET", "/v1/missions/{mission}/decisions", reading.decisions),
    operation("GET", "/v1/missions/{mission}/decisions/{step}", reading.decision),
    operation("GET", "/v1/missions/{mission}/beliefs", reading.beliefs),
    operation("GET", "/v1/missions/{mission}/activations", reading.activations),
    operation("GET", "/v1/missions/{mission}/world", run_files.pictures),
    operation("GET", "/v1/missions/{mission}/world/{step}", run_files.picture, media="image/png"),
    operation("GET", "/v1/missions/{mission}/documents", documents.documents),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/why", study.why),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/tree", study.tree),
    operation("GET", "/v1/missions/{mission}/decisions/{step}/picture", state_picture, media="image/svg+xml"),
    operation("POST", "/v1/missions/{mission}/decisions/{step}/whatif", study.what_if),
    operation("GET", "/v1/events", reading.events, media=EVENT_STREAM, gives=None),
)
