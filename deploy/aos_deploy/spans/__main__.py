"""The process that sends a run's spans: it reads the run directory, and is none of the bus.

What goes wrong is in its log, and no mission depends on it.
"""

import logging
import signal
import sys
import threading
from pathlib import Path

import msgspec

from aos_deploy.spans.otlp import Collector
from aos_deploy.spans.rest import REST
from aos_deploy.spans.sending import Sender
from aos_protocol.errors import AosError
from aos_runtime.processes.settings import ServiceSettings

_LOOK_S = 2.0
_SEND_S = 10.0
_REST_SEND_S = 3.0
"""Nobody works any more by then, and aos-up waits."""

_log = logging.getLogger("aos.spans")


class Settings(ServiceSettings, frozen=True, kw_only=True):
    """The settings of any service, and the address that spans go to."""

    otlp: str


def main(settings: Settings, *, is_rest: bool) -> None:
    """Sends what is new until the process is told to end; of the rest only what there is."""
    has_to_end = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: has_to_end.set())
    timeout_s = _REST_SEND_S if is_rest else _SEND_S
    collector = Collector(settings.otlp, settings.robot, timeout_s=timeout_s)
    sender = Sender(Path(settings.run_dir), collector, keeps_place=True)
    told = _send(sender, collector.address, "")
    while not is_rest and not has_to_end.wait(_LOOK_S):
        told = _send(sender, collector.address, told)


def _send(sender: Sender, address: str, told: str) -> str:
    """Sends once. What goes wrong is told once, however often it does."""
    try:
        number, is_whole = sender.send()
        trouble = "" if is_whole else f"{address} does not take spans; they are sent once it does"
        if number:
            _log.info("%d spans sent", number)
    except (AosError, OSError) as error:
        trouble = f"spans wait: {error}"
    if trouble and trouble != told:
        _log.warning("%s", trouble)
    return trouble


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    logging.getLogger("opentelemetry").setLevel(logging.CRITICAL)
    main(msgspec.json.decode(Path(sys.argv[1]).read_bytes(), type=Settings), is_rest=sys.argv[2:] == [REST])
