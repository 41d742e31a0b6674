"""The time that `aos lint` takes, on this machine, now: for bundles, or for some with one mistake each.

    python tests/lint_times.py [BUNDLE ...]

Models are compiled anew, and the engine once before, as set-up does it. Each line has the processor time of
the command with all its processes, the real time, and what was told first.
"""

import argparse
import asyncio
import os
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from aos_solver.building.engine_build import ANY_SIZE, STATE_BYTES, build_engine

HALL = """project: hall
horizon: 4
discount: 0.9

state_variable: int place
state_variable: int cells []
code:
state.cells = {1, 2, 3};

initial_belief:
state.place = 0;

reward_code:
if (state.place == 3 && state.cells[0] == 1) { __reward = 10; __isGoalState = true; }
"""
WALK = """project: hall

dynamic_model:
state__.place = state.place + 1;
CODE
__moduleResponse = walked;
"""
MAPPING = """project: hall
response: walked
response_rule: True

module_activation: ros_service
path: /walk
srv: walk
"""
DEEP = "std::integral_constant<int, N - 1>{}"
RECURSIVE = (
    "auto sum = []<int N>(auto self, std::integral_constant<int, N>) -> int {\n"
    f"    if constexpr (N == 0) return 0; else return N + self(self, {DEEP}); }};\n"
    "state__.place = sum(sum, std::integral_constant<int, 800>{});"
)
BRANCHING = (
    "auto sum = []<int N, int K>(auto self, std::integral_constant<int, N>,\n"
    "    std::integral_constant<int, K>) -> int {\n"
    f"    if constexpr (N == 0) return K;\n"
    f"    else return self(self, {DEEP}, std::integral_constant<int, 2 * K>{{}})\n"
    f"        + self(self, {DEEP}, std::integral_constant<int, 2 * K + 1>{{}}); }};\n"
    "state__.place = sum(sum, std::integral_constant<int, 16>{}, std::integral_constant<int, 0>{});"
)
MISTAKES = {
    "a null pointer": "int* nothing = nullptr; *nothing = 1;",
    "a write far away": "int* far = (int*)0x10; far[state.place] = 1;",
    "an endless loop": "int i = 0; while (i >= 0) { i = state.place; state__.place = i; }",
    "an endless loop that is empty": "volatile bool is_on = true; while (is_on) {}",
    "an endless loop of draws": "while (true) { if (AOS.Bernoulli(0.5) && state.place < 0) break; }",
    "an endless loop in a late state": "while (state.place == 2) { state__.place = 3; }",
    "recursion without end": "std::function<int(int)> f = [&](int x) { return f(x + 1) + 1; }; f(1);",
    "an exception": "if (state.place == 2) throw 1;",
    "an exception of the library": "std::vector<int> two(2); two.at(state.place + 1) = 1;",
    "a bad index": "state__.cells[state.place + 2] = 1;",
    "too many elements": "while (true) state__.cells.push_back(1);",
    "a division by zero": "int left = state.place == 7 ? 1 : 0; state__.place += 3 / left;",
    "the end of the program": "if (state.place == 1) exit(0);",
    "an abort": "if (state.place == 1) abort();",
    "a reward without end": "__reward = 1.0 / (state.place - 1);",
    "a reward that is no number": "__reward = sqrt(-1.0 - state.place);",
    "negative weights": "std::vector<double> w{0.5, -0.5}; state__.place += AOS.SampleDiscrete(w);",
    "too much memory": "std::vector<char> much(size_t{1} << 40); state__.place += much[0];",
    "deep templates": RECURSIVE,
    "many templates": BRANCHING,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bundles", nargs="*", type=Path)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        bundles = [(path.name, path) for path in options.bundles] or list(wrong_bundles(scratch))
        for state_bytes in (STATE_BYTES[0], ANY_SIZE):
            asyncio.run(build_engine(scratch / "cache", state_bytes=state_bytes))
        spent = [one_lint(name, path, scratch) for name, path in bundles]
    sys.stdout.write(
        f"{len(spent)} bundles: {min(spent):.2f} to {max(spent):.2f} s of processor time, "
        f"median {statistics.median(spent):.2f} s\n"
    )


def wrong_bundles(scratch: Path) -> Iterator[tuple[str, Path]]:
    for number, (name, code) in enumerate(MISTAKES.items()):
        bundle = scratch / f"bundle{number}"
        bundle.mkdir()
        (bundle / "hall.ef").write_text(HALL)
        (bundle / "walk.sd").write_text(WALK.replace("CODE", code))
        (bundle / "walk.am").write_text(MAPPING)
        yield name, bundle


def one_lint(name: str, bundle: Path, scratch: Path) -> float:
    """Its processor time in seconds."""
    for model in (scratch / "cache").glob("model-*"):
        shutil.rmtree(model)
    errors_file = scratch / "told"
    command = [str(Path(sys.executable).with_name("aos")), "lint", str(bundle)]
    environment = {**os.environ, "AOS_CACHE_DIR": str(scratch / "cache"), "NO_COLOR": "1"}
    began_s = time.monotonic()
    with errors_file.open("wb") as out:
        to_file = [(os.POSIX_SPAWN_DUP2, out.fileno(), 1), (os.POSIX_SPAWN_DUP2, out.fileno(), 2)]
        process = os.posix_spawn(command[0], command, environment, file_actions=to_file)
        _, _, usage = os.wait4(process, 0)
    spent_s, real_s = usage.ru_utime + usage.ru_stime, time.monotonic() - began_s
    first = next((line for line in errors_file.read_text().splitlines() if not line.startswith("aos: ")), "")
    sys.stdout.write(f"{spent_s:6.2f} s {real_s:6.2f} s  {name:32}  {first[:90]}\n")
    return spent_s


if __name__ == "__main__":
    main()
