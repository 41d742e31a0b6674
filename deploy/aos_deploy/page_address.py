"""The page of a run: the address of the gateway that runs on this machine, or of one that is started for
it.
"""

import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import IO

import msgspec

from aos_deploy.places import gateway_folder
from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import DeployError

_UNUSED_S = 600.0
"""A gateway that is started for a run ends when nobody has looked, and no mission has run, for so long."""
_START_S = 20.0
_LOOK_S = 0.05
_ANSWER_S = 2.0


class GatewayNote(msgspec.Struct, frozen=True):
    """The note by which a gateway is found: its address and process, and after how long it ends unused."""

    address: str
    pid: int
    unused_s: float | None = None


def page_texts(run: Path) -> list[str]:
    """Tells the address of a run's page, with the token, and how long it stays.

    It starts a gateway if none runs. DeployError AOS805 if it cannot be started.
    """
    gateway = _found() or _started(run.parent)
    _show_run(gateway.address)
    texts = [f"page {gateway.address}#/runs/{run.name}?token={_token()}"]
    if gateway.unused_s is not None:
        texts.append(
            f"the page stays after the mission, until nobody has looked at it for {gateway.unused_s:g} s"
        )
    return texts


def _found() -> GatewayNote | None:
    try:
        note = msgspec.json.decode((gateway_folder() / "gateway.json").read_bytes(), type=GatewayNote)
        with _answer(note.address, "v1/openapi.json"):
            return note
    except (OSError, *UNREADABLE):
        return None


def _show_run(address: str) -> None:
    """Lets a gateway of other folders look for runs now: those that it has seen living stay in view."""
    with suppress(OSError), _answer(address, "v1/runs"):
        pass


def _answer(address: str, path: str) -> IO[bytes]:
    # It takes 11 ms to import, and few runs show their page.
    from urllib.request import Request, urlopen

    asked = Request(f"{address}{path}", headers={"Authorization": f"Bearer {_token()}"})
    answer: IO[bytes] = urlopen(asked, timeout=_ANSWER_S)
    return answer


def _token() -> str:
    return (gateway_folder() / "token").read_text().strip()


def _started(runs: Path) -> GatewayNote:
    gateway_folder().mkdir(parents=True, exist_ok=True)
    log = gateway_folder() / "gateway.log"
    command = [sys.executable, "-m", "aos_gateway", "--port", "0", "--unused", str(_UNUSED_S)]
    with log.open("ab") as said:
        process = subprocess.Popen(
            [*command, "--runs", str(runs)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
        )
    until_s = time.monotonic() + _START_S
    while time.monotonic() < until_s and process.poll() is None:
        if (gateway := _found()) is not None:
            return gateway
        time.sleep(_LOOK_S)
    hint = "pip install 'aos-autonomy[page]' brings what it needs"
    raise DeployError(f"the page cannot be served; {log} says why", code="AOS805", hint=hint)
