"""The page's files, which a browser gets compressed. They are made by `make page`, and come with AOS.

A file whose name ends in `.gz` is kept compressed, and is known by the name without that.
"""

from __future__ import annotations

import gzip
import hashlib
from collections.abc import Awaitable, Callable
from pathlib import Path

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

__all__ = ["page_routes"]

_FOLDER = Path(__file__).resolve().parent / "page"
_MEDIA = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}


def page_routes() -> list[Route]:
    """A route for each file; the page itself is at the root."""
    routes = []
    for path in sorted(_FOLDER.iterdir()) if _FOLDER.is_dir() else ():
        name = path.name.removesuffix(".gz")
        media = _MEDIA.get(Path(name).suffix)
        if media is not None:
            place = "/" if name == "index.html" else f"/{name}"
            routes.append(Route(place, _answer_of(path, media), methods=["GET"]))
    return routes


def _answer_of(path: Path, media: str) -> Callable[[Request], Awaitable[Response]]:
    kept = path.read_bytes()
    is_packed = path.suffix == ".gz"
    data = gzip.decompress(kept) if is_packed else kept
    packed = kept if is_packed else gzip.compress(data, 9, mtime=0)
    tag = f'"{hashlib.sha256(data).hexdigest()[:16]}"'

    async def answer(request: Request) -> Response:
        headers = {"etag": tag, "cache-control": "no-cache", "vary": "accept-encoding"}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(packed, 200, headers | {"content-encoding": "gzip"}, media)
        return Response(data, 200, headers, media)

    return answer
