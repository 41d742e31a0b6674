"""The page's files, which a browser gets compressed. They are made by `make page`, and come with AOS.

They are kept compressed: `page.js` as `page.js.gz`.
"""

import contextlib
import gzip
import hashlib
import zlib
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Self

import msgspec
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

_FOLDER = Path(__file__).resolve().parents[1] / "page"
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
    for path in sorted(_FOLDER.glob("*.gz")):
        name = path.stem
        media = _MEDIA.get(Path(name).suffix)
        if media is not None:
            place = "/" if name == "index.html" else f"/{name}"
            routes.append(Route(place, _answer_of(path, media), methods=["GET"]))
    return routes


class _Content(msgspec.Struct, frozen=True):
    """A file's content, plain and packed, and the tag that browsers know it by."""

    plain: bytes
    packed: bytes
    tag: str

    @classmethod
    def of(cls, path: Path) -> Self:
        packed = path.read_bytes()
        plain = gzip.decompress(packed)
        return cls(plain, packed, f'"{hashlib.sha256(plain).hexdigest()[:16]}"')


class _File:
    """A file of the page, read again once `make page` has made it anew."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._made_at_ns = path.stat().st_mtime_ns
        self._content = _Content.of(path)

    def content(self) -> _Content:
        # While it is being written, what was read before is as good.
        with contextlib.suppress(OSError, EOFError, zlib.error):
            made_at_ns = self._path.stat().st_mtime_ns
            if made_at_ns != self._made_at_ns:
                self._content, self._made_at_ns = _Content.of(self._path), made_at_ns
        return self._content


def _answer_of(path: Path, media: str) -> Callable[[Request], Awaitable[Response]]:
    file = _File(path)

    async def answer(request: Request) -> Response:
        content = file.content()
        headers = {"etag": content.tag, "cache-control": "no-cache", "vary": "accept-encoding"}
        if request.headers.get("if-none-match") == content.tag:
            return Response(status_code=304, headers=headers)
        if "gzip" in request.headers.get("accept-encoding", ""):
            return Response(content.packed, 200, headers | {"content-encoding": "gzip"}, media)
        return Response(content.plain, 200, headers, media)

    return answer
