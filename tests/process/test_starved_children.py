import os
import sys
import time
from collections.abc import AsyncIterator

import pytest

from aos_runtime.processes.children import PIPE, Child, guarded

BURN = "import time\nwhile time.process_time() < 0.25: pass\nprint('burnt', flush=True)"
BURN_TWICE = f"{BURN}\n{BURN.replace('0.25', '0.5')}"
COMPETITOR = "print(flush=True)\nwhile True: pass"


@pytest.fixture
async def one_busy_processor() -> AsyncIterator[None]:
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    command = guarded([sys.executable, "-c", COMPETITOR])
    competitors = [await Child.start(command, stdout=PIPE) for _ in range(3)]
    try:
        for competitor in competitors:
            await competitor.stdout.readline()
        yield
    finally:
        for competitor in competitors:
            await competitor.stop()
        os.sched_setaffinity(0, before)


@pytest.mark.usefixtures("one_busy_processor")
async def test_the_time_in_which_a_child_waits_for_a_processor_does_not_count():
    # Beside three others it has a quarter of the processor, and needs more than the deadline. Where twenty
    # more run it has a sixth of that.
    child = await Child.start(guarded([sys.executable, "-c", BURN]), stdout=PIPE)
    assert await child.in_time(child.stdout.readline(), 0.7) == b"burnt\n"
    await child.wait()


@pytest.mark.usefixtures("one_busy_processor")
async def test_the_time_for_a_start_leaves_out_what_a_child_waited_for_a_processor_before_it_was_awaited():
    began_s = time.monotonic()
    child = await Child.start(guarded([sys.executable, "-c", BURN_TWICE]), stdout=PIPE)
    await child.stdout.readline()
    spent_s = time.monotonic() - began_s
    assert await child.in_time(child.stdout.readline(), 0.7, spent_s=spent_s) == b"burnt\n"
    await child.wait()


@pytest.mark.usefixtures("one_busy_processor")
async def test_a_child_that_wants_no_processor_has_its_deadline_and_no_more():
    child = await Child.start(["sleep", "1000"], stdout=PIPE)
    with pytest.raises(TimeoutError):
        await child.in_time(child.stdout.readline(), 0.3)
    await child.stop()
