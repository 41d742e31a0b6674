"""A link between two network namespaces that delays packets, loses some, or is cut.

Two TUN devices, and this process between them: kernels without `netem` have it too.
"""

import fcntl
import heapq
import os
import random
import select
import signal
import struct
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_TUNSETIFF = 0x400454CA
_IFF_TUN, _IFF_NO_PI = 0x0001, 0x1000
_LONGEST_PACKET = 65536


class Wire:
    """The fate of packets. `delay_s` is that of a round trip, `loss` the share lost on each way."""

    def __init__(self, ends: tuple[int, int]):
        self.delay_s = 0.0
        self.loss = 0.0
        self.is_cut = False
        self._ends = ends
        self._chance = random.Random(1)
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._carry)
        self._thread.start()

    def close(self):
        """Ends the link, and its devices with it."""
        self._is_over.set()
        self._thread.join()
        for end in self._ends:
            os.close(end)

    def _carry(self):
        under_way: list[tuple[float, int, int, bytes]] = []
        other = dict(zip(self._ends, reversed(self._ends), strict=True))
        number = 0
        while not self._is_over.is_set():
            wait_s = max(0.0, under_way[0][0] - time.monotonic()) if under_way else 0.1
            for end in select.select(self._ends, [], [], min(wait_s, 0.1))[0]:
                packet = os.read(end, _LONGEST_PACKET)
                if self.is_cut or self._chance.random() < self.loss:
                    continue
                number += 1
                due_s = time.monotonic() + self.delay_s / 2
                heapq.heappush(under_way, (due_s, number, other[end], packet))
            while under_way and under_way[0][0] <= time.monotonic():
                _, _, end, packet = heapq.heappop(under_way)
                if not self.is_cut:
                    os.write(end, packet)


@contextmanager
def wire(namespace: str, here: str, there: str) -> Iterator[Wire]:
    ip("netns", "add", namespace)
    try:
        near, far = (_tun(f"{namespace}{number}") for number in (0, 1))
        ip("link", "set", f"{namespace}1", "netns", namespace)
        for words, device, address, other in (
            ((), f"{namespace}0", here, there),
            (("-n", namespace), f"{namespace}1", there, here),
        ):
            ip(*words, "addr", "add", address, "peer", other, "dev", device)
            ip(*words, "link", "set", device, "up")
        ip("-n", namespace, "link", "set", "lo", "up")
        made = Wire((near, far))
        try:
            yield made
        finally:
            made.close()
    finally:
        # A connection that was cut is never ended here: what sshd has started for it would stay.
        for pid in ip("netns", "pids", namespace).split():
            with suppress(ProcessLookupError):
                os.kill(int(pid), signal.SIGKILL)
        ip("netns", "del", namespace)


def _tun(name: str) -> int:
    """The descriptor of a new TUN device; the device goes with it."""
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
    fcntl.ioctl(end, _TUNSETIFF, struct.pack("16sH22x", name.encode(), _IFF_TUN | _IFF_NO_PI))
    return end


def ip(*words: str) -> str:
    """Runs the command `ip`; returns what it prints."""
    return subprocess.run(["ip", *words], check=True, stdout=subprocess.PIPE, text=True).stdout
