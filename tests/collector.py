"""A collector of OpenTelemetry's spans: a real server for OTLP over HTTP, in this process."""

import gzip
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest


class Collected:
    """The spans that have come, by id, each as protobuf with its service's name; `status` is the answer."""

    def __init__(self) -> None:
        self.address = ""
        self.status = 200
        self.spans: dict[str, tuple[str, Any]] = {}
        self.headers: dict[str, str] = {}

    def take(self, body: bytes, service_pb2: Any) -> None:
        for resource in service_pb2.ExportTraceServiceRequest.FromString(body).resource_spans:
            said = {each.key: each.value.string_value for each in resource.resource.attributes}
            for scope in resource.scope_spans:
                for span in scope.spans:
                    self.spans[span.span_id.hex()] = (said["service.name"], span)


@contextmanager
def collector() -> Iterator[Collected]:
    """A collector on a free port. The test is skipped where OpenTelemetry is not installed."""
    why = "the extra `otel` is not installed"
    service_pb2 = pytest.importorskip("opentelemetry.proto.collector.trace.v1.trace_service_pb2", reason=why)
    collected = Collected()

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["content-length"]))
            collected.headers = {name.lower(): text for name, text in self.headers.items()}
            if collected.status == 200 and self.path == "/v1/traces":
                is_packed = self.headers.get("content-encoding") == "gzip"
                collected.take(gzip.decompress(body) if is_packed else body, service_pb2)
            self.send_response(collected.status if self.path == "/v1/traces" else 404)
            self.send_header("content-length", "0")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Says nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    collected.address = f"http://127.0.0.1:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield collected
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
