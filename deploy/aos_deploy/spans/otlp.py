"""The way to a collector: OTLP over HTTP by OpenTelemetry's SDK, from the extra `otel`.

Headers, certificates and compression are the SDK's: it reads `OTEL_EXPORTER_OTLP_HEADERS` and the like.
"""

from __future__ import annotations

import math
import socket
from collections import defaultdict
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from aos_deploy.spans.spans import Span
from aos_protocol import __version__
from aos_protocol.errors import DeployError
from aos_runtime.distribution import pip_install

if TYPE_CHECKING:
    from opentelemetry.sdk.trace import ReadableSpan

_NEEDS = ("opentelemetry.sdk", "opentelemetry.exporter.otlp.proto.http")
_PATH = "/v1/traces"


def check_otel_installed() -> None:
    """Raises DeployError AOS805 where OpenTelemetry's packages are not installed."""
    if not all(map(_is_there, _NEEDS)):
        message = "spans need OpenTelemetry's packages, which are not installed"
        raise DeployError(message, code="AOS805", hint=f"Run {pip_install('otel')}")


def _is_there(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:  # A package above it is not there.
        return False


class Collector:
    """A collector that takes OTLP over HTTP, at `address`: without a path that is `/v1/traces` of it.

    Sending may take `timeout_s`. DeployError AOS805 where the packages are not installed.
    """

    def __init__(self, address: str, robot: str, *, timeout_s: float = 10.0) -> None:
        check_otel_installed()
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter

        self.address = address.rstrip("/") + _PATH if urlsplit(address).path in ("", "/") else address
        self._robot = robot
        self._timeout_s = timeout_s
        # Its type of the timeout is whole seconds, what it does with it is not.
        self._exporter: Any = OTLPSpanExporter(endpoint=self.address, timeout=timeout_s)

    def check_reachable(self) -> None:
        """Raises DeployError AOS805 where nobody listens at the address: `send` would try until its timeout.

        Behind a proxy nobody knows before something is sent.
        """
        from urllib.request import getproxies, proxy_bypass

        parts = urlsplit(self.address)
        host = parts.hostname or ""
        if parts.scheme in getproxies() and not proxy_bypass(host):
            return
        port = parts.port or (443 if parts.scheme == "https" else 80)
        try:
            socket.create_connection((host, port), timeout=self._timeout_s).close()
        except OSError as error:
            message = f"no collector answers at {host}, port {port}: {error.strerror or error}"
            hint = "Start a collector that takes OTLP over HTTP, or name another address"
            raise DeployError(message, code="AOS805", hint=hint) from error

    def send(self, spans: Sequence[Span]) -> bool:
        """Sends spans and says whether the collector has taken them; waits, so call it in a thread."""
        from opentelemetry.sdk.trace.export import SpanExportResult

        return bool(self._exporter.export(self._read(spans)) is SpanExportResult.SUCCESS)

    def close(self) -> None:
        """Closes the connection; a `send` in another thread gives up."""
        self._exporter.shutdown()

    def _read(self, spans: Sequence[Span]) -> list[ReadableSpan]:
        from opentelemetry.sdk.resources import Resource

        by_service: dict[str, list[Span]] = defaultdict(list)
        for span in spans:
            by_service[span.service].append(span)
        read: list[ReadableSpan] = []
        for service, group in by_service.items():
            resource = Resource(
                {"service.name": service, "service.version": __version__, "aos.robot": self._robot}
            )
            read += [_readable(span, resource) for span in group]
        return read


def _readable(span: Span, resource: Any) -> ReadableSpan:
    from opentelemetry.sdk.trace import ReadableSpan
    from opentelemetry.trace import SpanContext, Status, StatusCode, TraceFlags

    def context(identifier: str) -> SpanContext:
        flags = TraceFlags(TraceFlags.SAMPLED)
        return SpanContext(int(span.trace_id, 16), int(identifier, 16), is_remote=False, trace_flags=flags)

    return ReadableSpan(
        name=span.name,
        context=context(span.span_id),
        parent=context(span.parent_id) if span.parent_id else None,
        resource=resource,
        attributes={name: value for name, value in span.attributes.items() if _says_something(value)},
        status=Status(StatusCode.ERROR, span.error) if span.error else Status(StatusCode.OK),
        start_time=span.start_ns,
        end_time=span.end_ns,
    )


def _says_something(value: Any) -> bool:
    return value != "" and not (isinstance(value, float) and math.isnan(value))
