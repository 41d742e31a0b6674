import errno
import os
import re
import struct
from pathlib import Path

import pytest

from aos_runtime.sandbox import system_calls
from aos_runtime.sandbox.profiles import program_of
from aos_runtime.sandbox.seccomp import ALLOW, KILL, TRAP, fail_with
from aos_runtime.sandbox.system_calls import ARCHITECTURES, numbers_of

PID = 4711
START = (0x7F00_1234_5678, 0x7F00_1234_6000, 0x7F00_1234_7000)
REFUSED = fail_with(errno.EPERM)
ABSENT = fail_with(errno.ENOSYS)
THREAD = 0x3D0F00
HEADERS = {
    "x86_64": Path("/usr/include/x86_64-linux-gnu/asm/unistd_64.h"),
    "aarch64": Path("/usr/include/asm-generic/unistd.h"),
}

pytestmark = pytest.mark.parametrize("machine", ["x86_64", "aarch64"])


def answer(program: bytes, number: int, arguments: tuple[int, ...] = (), architecture: int = 0) -> int:
    """The action that a program takes for a call: the instructions of linux/filter.h that ours have."""
    words = [*arguments, 0, 0, 0, 0, 0, 0][:6]
    data = struct.pack("=iIQ6Q", number, architecture, 0, *words)
    place, value = 0, 0
    for _ in range(4096):
        code, if_true, if_false, operand = struct.unpack_from("=HBBI", program, 8 * place)
        place += 1
        if code == 0x20:
            (value,) = struct.unpack_from("=I", data, operand)
        elif code == 0x54:
            value &= operand
        elif code == 0x15:
            place += if_true if value == operand else if_false
        elif code == 0x35:
            place += if_true if value >= operand else if_false
        else:
            assert code == 0x06
            return int(operand)
    raise AssertionError("the program does not end")


class Filter:
    def __init__(self, profile: str, machine: str):
        self.program = program_of(profile, machine, PID, START)
        self.numbers = numbers_of(machine)
        self.architecture = ARCHITECTURES[machine]

    def __call__(self, name: str, *arguments: int) -> int:
        return answer(self.program, self.numbers[name], arguments, self.architecture)


@pytest.mark.parametrize("profile", ["engine", "worker"])
def test_documents_code_computes_with_threads_and_reads(machine: str, profile):
    of = Filter(profile, machine)
    assert {of(name) for name in ("read", "write", "mmap", "futex", "exit_group", "getrandom")} == {ALLOW}
    assert of("clone", THREAD) == ALLOW
    assert of("openat", 0, 0, os.O_RDONLY | os.O_CLOEXEC) == ALLOW
    assert of("execve", *START) == ALLOW
    assert of("kill", PID, 15) == of("tgkill", PID, PID, 6) == ALLOW
    assert of("prlimit64", 0, 3, 0) == of("fcntl", 1, 4, 0) == ALLOW


@pytest.mark.parametrize(("profile", "refusal"), [("engine", TRAP), ("worker", REFUSED)])
def test_documents_code_does_nothing_else(machine: str, profile, refusal):
    of = Filter(profile, machine)
    refused = (
        "socket",
        "connect",
        "ptrace",
        "fchmodat",
        "utimensat",
        "truncate",
        "unlinkat",
        "io_uring_setup",
    )
    assert {of(name) for name in refused} == {refusal}
    assert of("clone", 17) == of("clone", THREAD | 0x10000000) == of("clone", THREAD | 0x4000) == refusal
    assert of("clone3") == ABSENT
    assert {of("openat", 0, 0, flags) for flags in (1, 2, os.O_CREAT, os.O_TRUNC, os.O_APPEND)} == {refusal}
    assert of("execve", START[0], START[1], 0) == of("execve", START[0] + (1 << 32), *START[1:]) == refusal
    assert of("kill", 1, 9) == of("kill", (1 << 32) - PID, 9) == of("tgkill", PID + 1, PID, 9) == refusal
    # Its own limits, another's, the signals of a descriptor's owner, and what is typed at a terminal.
    assert of("prlimit64", 0, 9, 4096) == of("prlimit64", PID, 0, 0) == REFUSED
    assert of("fcntl", 0, 8, PID) == of("fcntl", 0, 10, 9) == of("ioctl", 0, 0x5412) == REFUSED


def test_a_compiler_starts_processes_and_reaches_nobody(machine: str):
    of = Filter("compiler", machine)
    assert {of(name) for name in ("execve", "unlinkat", "renameat", "read")} == {ALLOW}
    assert of("clone", 17) == ALLOW
    assert of("clone", 17 | 0x10000000) == REFUSED
    refused = ("socket", "kill", "tgkill", "ptrace", "fchmodat", "truncate", "unshare", "mount", "bpf")
    assert {of(name) for name in refused} == {REFUSED}


@pytest.mark.parametrize("profile", ["compiler", "engine", "worker"])
def test_calls_of_other_architectures_and_of_32_bits_end_the_process(machine: str, profile):
    of = Filter(profile, machine)
    i386 = 0x40000003
    assert answer(of.program, 3, (), i386) == KILL
    assert {answer(of.program, number | 0x40000000, (), of.architecture) for number in (0, 59, 512)} == {KILL}


@pytest.mark.parametrize("profile", ["compiler", "engine", "worker"])
def test_calls_newer_than_the_table_are_as_in_an_older_kernel(machine: str, profile):
    of = Filter(profile, machine)
    assert {answer(of.program, number, (), of.architecture) for number in (446, 452, 463, 600)} == {ABSENT}


def test_the_numbers_are_those_of_the_kernels_headers(machine: str):
    if not HEADERS[machine].is_file():
        pytest.skip(f"needs the kernel's headers: {HEADERS[machine]}")
    lines = re.findall(r"#define __NR(?:3264)?_(\w+)\s+(\d+)", HEADERS[machine].read_text())
    known = {name: int(number) for name, number in lines}
    # The generic header has this name for what both machines call newfstatat.
    known.setdefault("newfstatat", known.get("fstatat", 0))
    newer = {name for name, number in numbers_of(machine).items() if number > max(known.values())}
    ours = {name: number for name, number in numbers_of(machine).items() if name not in newer}
    assert ours == {name: known[name] for name in ours}
    lacking = {name for name in known if name in numbers_of("x86_64")} - set(ours) - newer
    assert not lacking


def test_every_call_that_a_list_names_has_a_number(machine: str):
    lists = (
        system_calls.ALLOWED, system_calls.NETWORK, system_calls.OTHER_PROCESSES,
        system_calls.CHANGES_OF_OWNERS, system_calls.CHANGES_OF_FILES, system_calls.NEW_PROCESSES,
        system_calls.SYSTEM,
    )  # fmt: skip
    named = {name for names in lists for name in names}
    # The newer machine lacks the calls that others have replaced.
    assert named - set(numbers_of(machine)) <= named & (numbers_of("x86_64").keys() - numbers_of("aarch64"))
