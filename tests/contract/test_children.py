import asyncio
import gc
import os
import sys
from contextlib import suppress
from typing import Any

from aos_runtime.processes.children import Child


async def test_a_child_that_is_killed_while_it_is_told_something_leaves_nothing_in_the_log():
    faults: list[dict[str, Any]] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: faults.append(context))
    child = await Child.start(
        [sys.executable, "-c", "import time; time.sleep(60)"], stdin=asyncio.subprocess.PIPE
    )

    child.kill()
    with suppress(ChildProcessError):  # asyncio's thread may have waited for it; the loop has not heard.
        os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)  # noqa: ASYNC222
    child.stdin.write(b"a question\n")
    assert await child.wait() < 0

    del child
    gc.collect()
    await asyncio.sleep(0)
    assert not faults
