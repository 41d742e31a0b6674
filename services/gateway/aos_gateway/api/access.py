"""Access: the names by which the gateway answers, pages of other origins, and the token for writing.

A page of another site can make a browser send requests to this machine, and by a name of its own that leads
here (DNS rebinding) it could read the answers. So the `Host` of every request has to be one of the
gateway's names, and an `Origin` has to be the gateway itself, also on loopback.
"""

import hmac
import os
import secrets
import socket
from collections.abc import Iterable, Mapping
from ipaddress import ip_address
from pathlib import Path

import msgspec

from aos_protocol.errors import GatewayError, StorageError

COOKIE = "aos-token"
"""The cookie by which a browser that has shown the token may read where reading needs it."""

_ANY = ("0.0.0.0", "::")
_READING = ("GET", "HEAD")


class Access(msgspec.Struct, frozen=True):
    """The names that requests may give as host, the token, and whether reading needs it."""

    hosts: frozenset[str]
    token: str
    is_private: bool = True

    def check(
        self, method: str, headers: Mapping[str, str], cookies: Mapping[str, str], *, is_open: bool = False
    ) -> None:
        """Raises GatewayError AOS904 for a request from elsewhere, AOS903 for one that lacks the token.

        What `is_open` may be read by anybody: the files of the page, which say nothing of a robot.
        """
        host = headers.get("host", "").lower()
        if _without_port(host) not in self.hosts:
            hint = "Name it with `aos serve --host`"
            raise GatewayError(f"the gateway does not answer to the name {host!r}", code="AOS904", hint=hint)
        origin = headers.get("origin")
        if origin is not None and origin.partition("://")[2].lower() != host:
            raise GatewayError(f"a page of {origin} may not ask this gateway", code="AOS904")
        scheme, _, given = headers.get("authorization", "").partition(" ")
        has_token = scheme.lower() == "bearer" and self._is_token(given)
        if method in _READING and self.is_private:
            has_token = has_token or self._is_token(cookies.get(COOKIE, ""))
        if method in _READING and (is_open or not self.is_private):
            return
        if not has_token:
            what = "reading" if method in _READING else "writing"
            hint = "Open the address that `aos serve` prints, or send `Authorization: Bearer TOKEN`"
            raise GatewayError(f"{what} needs the token", code="AOS903", hint=hint)

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.strip().encode(), self.token.encode())


def access_of(listen: str, names: Iterable[str], token: str, *, is_private: bool) -> Access:
    """The access to a gateway that listens at this address. Reading needs the token, too, except on loopback
    where it is not private."""
    own = {"localhost", "127.0.0.1", "[::1]"}
    is_loopback = listen == "localhost" or ip_address(listen.strip("[]")).is_loopback
    if not is_loopback:
        own |= {socket.gethostname().lower(), socket.getfqdn().lower()}
    if listen not in _ANY:
        own.add(f"[{listen}]" if ":" in listen else listen)
    return Access(
        frozenset(own | {name.lower() for name in names}), token, is_private=is_private or not is_loopback
    )


def kept_token(path: Path) -> str:
    """The token in a file that nobody else may read, made if it is not there; StorageError AOS701 if it
    cannot be.

    It stays the same, so that a page goes on with a gateway that is started again.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(handle, "w") as file:
                file.write(secrets.token_urlsafe(24))
        return path.read_text().strip()
    except FileExistsError:
        return path.read_text().strip()
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror}") from error


def _without_port(host: str) -> str:
    name, colon, port = host.rpartition(":")
    return name if colon and port.isdigit() else host
