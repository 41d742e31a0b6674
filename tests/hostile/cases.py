"""The hostile code: each case by name, as it stands in a document, on one line of it.

`SECRET` stands for a file of mode 600 that belongs to the user, `FOLDER` for its folder.
"""

import os

from aos_runtime.sandbox.system_calls import numbers_of

_X86_64 = (
    'asm volatile("syscall" : "=a"(REACHED) : "a"(NUMBERL), "D"((long)(A)), "S"((long)(B)), "d"((long)(C))'
    ' : "rcx", "r11", "memory", "r10", "r8");'
)
_AARCH64 = (
    'asm volatile("mov x8, %1\\n mov x0, %2\\n mov x1, %3\\n mov x2, %4\\n svc 0\\n mov %0, x0"'
    ' : "=r"(REACHED)'
    ' : "r"(NUMBERL), "r"((long)(A)), "r"((long)(B)), "r"((long)(C)) : "x0", "x1", "x2", "x8", "memory");'
)


def system_call(name: str, *arguments: str | int, result: str = "reached") -> str:
    machine = os.uname().machine
    first, second, third = (str(word) for word in (*arguments, 0, 0, 0)[:3])
    text = _X86_64 if machine == "x86_64" else _AARCH64
    text = text.replace("NUMBER", str(numbers_of(machine)[name])).replace("REACHED", result)
    text = text.replace("(A)", f"({first})").replace("(B)", f"({second})").replace("(C)", f"({third})")
    return f"long {result} = 0; {text}"


_PARENT = system_call("getppid", result="parent")

MODELS: dict[str, str] = {
    "reads a file": 'auto* f = std::fopen("SECRET", "r"); if (f) state__.count = std::fgetc(f);',
    "writes a file": 'auto* f = std::fopen("FOLDER/written", "w"); if (f) std::fputs("x", f);',
    "lists a folder": system_call("openat", -100, '"FOLDER"', 0o200000),
    "changes a mode": system_call("fchmodat", -100, '"SECRET"', 0o777),
    "opens a TCP socket": system_call("socket", 2, 1, 0),
    "opens a UDP socket": system_call("socket", 2, 2, 0),
    "opens a Unix socket": system_call("socket", 1, 1, 0),
    "forks": system_call("clone", 17, 0, 0),
    "starts threads": (
        "auto make = &::pthread_create; auto idle = [](void*) -> void* { for (;;) {} }; "
        "for (;;) { pthread_t thread; make(&thread, nullptr, idle, nullptr); }"
    ),
    "executes a program": 'auto run = &std::system; run("cat SECRET");',
    "kills its guard": f"{_PARENT} {system_call('kill', 'parent', 9)}",
    "traces its guard": f"{_PARENT} {system_call('ptrace', 16, 'parent', 0)}",
    "looks into /proc": 'auto* f = std::fopen("/proc/1/environ", "r"); if (f) state__.count = std::fgetc(f);',
    "never ends": "while (state.count >= 0) { state__.count = 1; }",
    "takes memory": (
        "for (;;) { auto* block = new char[1 << 24]; "
        "for (int i = 0; i < (1 << 24); i += 4096) block[i] = 1; }"
    ),
    "prints 1 GB": ("std::string line(63, 'x'); for (int i = 0; i < 16777216; ++i) std::puts(line.c_str());"),
}
"""Code of a skill's dynamic model."""

COMPILED: dict[str, str] = {
    "includes a binary": 'asm(".incbin \\"SECRET\\"");',
    "includes a text": '#include "SECRET"',
    "has a pragma": '_Pragma("GCC dependency \\"SECRET\\"") state__.count = 1; #pragma GCC poison int',
    "computes without end": (
        "constexpr auto spin = [] { long n = 0; for (long i = 0; i < 100000000000; ++i) n += i; return n; }; "
        "static_assert(spin() >= 0);"
    ),
    "expands without end": (
        "auto grow = []<int N, int K>(auto self, std::integral_constant<int, N>, "
        "std::integral_constant<int, K>) -> int { if constexpr (N == 0) return K; else "
        "return self(self, std::integral_constant<int, N - 1>{}, std::integral_constant<int, 2 * K>{}) + "
        "self(self, std::integral_constant<int, N - 1>{}, std::integral_constant<int, 2 * K + 1>{}); }; "
        "state__.count = grow(grow, std::integral_constant<int, 24>{}, std::integral_constant<int, 0>{});"
    ),
}
"""Code of a dynamic model that attacks the compiler, or through it."""

MAPPINGS: dict[str, str] = {
    "reads a file": 'value = open("SECRET").read()',
    "writes a file": 'value = open("FOLDER/written", "w").write("x")',
    "lists a folder": 'import os; value = os.listdir("FOLDER")',
    "changes a mode": 'import os; value = os.chmod("SECRET", 0o777)',
    "opens a TCP socket": 'import socket; value = socket.create_connection(("127.0.0.1", 22))',
    "opens a UDP socket": "import socket; value = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
    "opens a Unix socket": "import socket; value = socket.socket(socket.AF_UNIX)",
    "forks": "import os; value = os.fork()",
    "executes a program": 'import subprocess; value = subprocess.check_output(["cat", "SECRET"])',
    "kills its guard": "import os, signal; value = os.kill(os.getppid(), signal.SIGKILL)",
    "never ends": "while True: value = 1",
    "takes memory": "value = bytearray(1 << 36)",
}
"""Code of a mapping's local variable."""
