"""Lines that tell how far work is, for logs and pipes."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

LINE_EVERY_S = 20.0
TICK_S = 1.0


class TimedLines:
    """Tells how far work is in lines, for logs: the first after `first_s`, then one every LINE_EVERY_S.

    While it is `ticking`, they come also where the work itself tells nothing.
    """

    def __init__(self, what: str, first_s: float | None = None) -> None:
        self._what = what
        self._text = ""
        self._pause_s = LINE_EVERY_S if first_s is None else first_s
        self._began_s = self._told_s = time.monotonic()
        self._lock = threading.Lock()

    def tell(self, text: str) -> None:
        with self._lock:
            self._text = text
            now_s = time.monotonic()
            if now_s - self._told_s < self._pause_s:
                return
            self._told_s, self._pause_s = now_s, LINE_EVERY_S
            if sys.stderr is not None:
                how_far = f": {text}" if text else ""
                sys.stderr.write(f"aos: {self._what} for {now_s - self._began_s:.0f} s{how_far}\n")
                sys.stderr.flush()

    @contextmanager
    def ticking(self) -> Iterator[None]:
        """Tells the last text again, when a line is due, until the block ends."""
        has_ended = threading.Event()
        clock = threading.Thread(target=self._tick, args=(has_ended,), daemon=True)
        clock.start()
        try:
            yield
        finally:
            has_ended.set()
            clock.join(TICK_S)

    def _tick(self, has_ended: threading.Event) -> None:
        while not has_ended.wait(TICK_S):
            self.tell(self._text)
