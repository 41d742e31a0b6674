import asyncio
import os

import pytest

from aos_deploy.deployment.own_programs import ReadyPart
from aos_deploy.processes.ready import before_start, until_seen_ready
from aos_runtime.clock import SystemClock, moment_s

_LONG_ENOUGH_S = 0.3
"""Files are looked at several times meanwhile."""


@pytest.mark.parametrize("is_there", [True, False])
async def test_a_file_of_an_earlier_run_does_not_count_and_one_that_is_written_does(tmp_path, is_there):
    pid, log, ready = tmp_path / "pid", tmp_path / "log", ReadyPart(file="pid")
    if is_there:
        pid.write_text("1")
        os.utime(pid, (2**32, 2**32))  # The clock has been set back since.
    before = before_start(ready, log, tmp_path)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(_LONG_ENOUGH_S):
            await until_seen_ready(ready, log, before, tmp_path)
    pid.write_text("2")
    os.utime(pid, (0, 0))
    await until_seen_ready(ready, log, before, tmp_path)


class _SetBack(SystemClock):
    def now_ns(self) -> int:
        return super().now_ns() - 3600 * 10**9

    def monotonic_s(self) -> float:
        return 100.0


def test_a_moment_of_a_journal_is_never_later_than_now():
    stamp_ns = SystemClock().now_ns()
    assert moment_s(_SetBack(), stamp_ns) == 100.0
    assert moment_s(_SetBack(), stamp_ns - 3610 * 10**9) == pytest.approx(90.0, abs=1.0)
