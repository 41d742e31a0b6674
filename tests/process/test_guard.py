import os
import signal
import sys
from pathlib import Path

import pytest
from processes import HANG_S, descendants, until_ended

from aos_runtime.processes.children import PIPE, Child, Limits, guarded

SLEEPERS = "sleep 1000 & setsid sleep 1000 & echo $$; {tail}"


async def start(script: str, limits: Limits | None = None) -> Child:
    command = guarded(["sh", "-c", script], limits)
    return await Child.start(command, stdin=PIPE, stdout=PIPE, stderr=PIPE)


@pytest.mark.parametrize(
    ("script", "status"),
    [("exit 0", 0), ("exit 3", 3), ("kill -SEGV $$", -signal.SIGSEGV), ("kill -KILL $$", -signal.SIGKILL)],
)
async def test_the_guard_ends_as_its_command_ends(script, status):
    child = await start(script)
    assert await child.wait() == status


async def test_input_and_output_are_the_commands(tmp_path):
    child = await start("read line; echo got $line; echo oops >&2")
    child.stdin.write(b"hello\n")
    assert (await child.stdout.readline(), await child.stderr.readline()) == (b"got hello\n", b"oops\n")
    await child.wait()


async def test_a_command_that_does_not_exist_is_named():
    child = await Child.start(guarded(["no-such-compiler"]), stderr=PIPE)
    assert await child.wait() == 127
    assert b"cannot start no-such-compiler: No such file" in await child.stderr.read()


async def test_a_nicer_command_is_nicer_than_the_processes_of_every_session():
    command = f"{sys.executable} -c 'import os; print(os.nice(0))'; cat /proc/self/autogroup 2>/dev/null"
    child = await start(command, Limits(niceness=7))
    nice, *session = (await child.stdout.read()).decode().splitlines()
    assert int(nice) == min(os.nice(0) + 7, 19)
    assert session == [] or session[0].endswith("nice 7")  # A kernel without sessions of its own has none.
    await child.wait()


async def test_what_a_command_leaves_running_is_ended_with_it():
    child = await start(SLEEPERS.format(tail="read line"))
    await child.stdout.readline()
    below = descendants(child.pid)
    assert len(below) == 4  # the keeper, the shell and two sleepers
    child.stdin.write(b"end\n")
    assert await child.wait() == 0
    await until_ended(below)


async def test_stopping_the_guard_ends_everything_below_it():
    child = await start(SLEEPERS.format(tail="wait"))
    await child.stdout.readline()
    below = descendants(child.pid)
    assert await child.stop() == -signal.SIGTERM
    await until_ended(below)


async def test_a_command_that_ignores_sigterm_is_killed_after_the_grace():
    child = await start("trap '' TERM; echo up; while true; do sleep 1000; done", Limits(grace_s=0.1))
    await child.stdout.readline()
    below = descendants(child.pid)
    assert await child.stop(grace_s=5) == -signal.SIGKILL
    await until_ended(below)


async def test_what_an_ended_command_left_behind_is_told_and_killed_though_it_ignores_sigterm():
    script = "sh -c \"trap '' TERM; echo up; while true; do sleep 1000; done\" & read line; exit 3"
    child = await start(script, Limits(grace_s=HANG_S, left_behind_s=0.1))
    await child.stdout.readline()
    below = descendants(child.pid)
    child.stdin.write(b"end\n")
    assert await child.wait_for(HANG_S / 2)
    assert child.returncode == 3
    assert b" (sh) went on after SIGTERM, and is killed" in await child.stderr.read()
    await until_ended(below)


START_GUARDED = f"""
import asyncio, sys
from aos_runtime.processes.children import Child, PIPE, guarded
async def main():
    child = await Child.start(guarded(["sh", "-c", {SLEEPERS.format(tail="wait")!r}]), stdout=PIPE)
    await child.stdout.readline()
    print("up", flush=True)
    await child.wait()
asyncio.run(main())
"""


@pytest.mark.parametrize("frozen", [[], [0], [1], [0, 1]], ids=["none", "guard", "keeper", "both"])
async def test_grandchildren_end_when_the_parent_is_killed_though_guard_or_keeper_is_frozen(frozen):
    parent = await Child.start([sys.executable, "-c", START_GUARDED], stdout=PIPE)
    await parent.stdout.readline()
    below = descendants(parent.pid)
    assert len(below) == 5  # the guard as well
    for number in frozen:
        os.kill(below[number], signal.SIGSTOP)
    os.kill(parent.pid, signal.SIGKILL)
    await parent.wait()
    await until_ended(below)


@pytest.mark.parametrize("is_frozen", [False, True], ids=["runs", "is frozen"])
async def test_all_that_a_command_started_ends_when_the_guard_itself_is_killed_and_the_keeper(is_frozen):
    child = await start(SLEEPERS.format(tail="wait"))
    await child.stdout.readline()
    below = descendants(child.pid)
    assert len(below) == 4
    if is_frozen:
        os.kill(below[0], signal.SIGSTOP)
    os.kill(child.pid, signal.SIGKILL)
    await child.wait()
    await until_ended(below)


async def test_a_guard_that_is_frozen_and_goes_on_has_lost_nothing():
    child = await start("echo up; read line; exit 3")
    await child.stdout.readline()
    for pid in (child.pid, descendants(child.pid)[0]):
        os.kill(pid, signal.SIGSTOP)
        os.kill(pid, signal.SIGCONT)
    child.stdin.write(b"end\n")
    assert await child.wait() == 3


@pytest.mark.parametrize(
    ("limits", "code", "status", "written"),
    [
        (Limits(address_space_bytes=300_000_000), "bytearray(2 * 10**9)", 1, {}),
        (Limits(cpu_s=1), "while True: pass", -signal.SIGKILL, {}),
        (Limits(file_bytes=1000), "open('out', 'wb').write(bytes(10**6))", 1, {"out": 1000}),
    ],
    ids=["memory", "processor time", "file size"],
)
async def test_limits_hold(limits: Limits, code, status, written, tmp_path):
    child = await Child.start(guarded([sys.executable, "-c", code], limits), cwd=tmp_path, stderr=PIPE)
    assert await child.wait() == status
    assert sizes(tmp_path) == written


def sizes(folder: Path) -> dict[str, int]:
    return {path.name: path.stat().st_size for path in folder.iterdir()}
