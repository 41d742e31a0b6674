import gc
import threading
import time
from collections.abc import Iterator

import pytest

from aos_language.python_syntax import module_of

TEXT = "\n".join(
    f"def area_{number}(a, b):\n    return [a * b + {number} for _ in range(3)]" for number in range(60)
)


class Yielding:
    """Garbage whose finalizer lets other threads run."""

    def __init__(self):
        self.itself = self

    def __del__(self):
        time.sleep(0)


@pytest.fixture
def _frequent_collections() -> Iterator[None]:
    before = gc.get_threshold()
    gc.set_threshold(200)
    yield
    gc.set_threshold(*before)


@pytest.mark.usefixtures("_frequent_collections")
def test_threads_that_parse_at_once_do_not_disturb_each_other():
    faults: list[BaseException] = []

    def parse():
        try:
            for _ in range(20):
                for _ in range(20):
                    Yielding()
                module_of(TEXT)
        except SystemError as fault:
            faults.append(fault)

    threads = [threading.Thread(target=parse) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
