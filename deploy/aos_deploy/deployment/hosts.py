"""The other hosts of a deploy file: `host:` and `folder:` of an adapter or a program, and a collector."""

import re
from typing import Any
from urllib.parse import urlsplit

from aos_language.findings import Findings
from aos_protocol.diagnostics import Span

HOST = re.compile(r"(ssh://)?([A-Za-z0-9_][\w.-]*@)?[A-Za-z0-9\[][A-Za-z0-9_.:\]-]*")
"""A text that ssh takes for a host; it cannot be one that ssh would take for an option."""


def check_host(path: str, host: Any, folder: Any, where: Span, findings: Findings) -> None:
    """Finds a `host` (None: not given) that ssh would not take or would take for an option, and a `folder`
    that is on no host. `path` names what has them: `programs.sim`."""
    if host is not None and not (isinstance(host, str) and HOST.fullmatch(host)):
        hint = "Write it as ssh takes it: robot@arm.local"
        findings.error("AOS106", f"{path}.host is no host: {host!r}", where, hint)
    if not isinstance(folder, str) or (folder and host is None):
        hint = "It is a folder on the other host; without a host the deploy file's folder is meant"
        findings.error("AOS106", f"{path}.folder is given without a host", where, hint)


def is_collector_address(address: str) -> bool:
    """Says whether spans can be sent there: an address with http or https and a host."""
    try:
        parts = urlsplit(address)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False
