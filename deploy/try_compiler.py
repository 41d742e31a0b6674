"""Builds a small program the way models are built, and says with which compiler.

Exit code 1 if there is none, 2 if it cannot build. The first build with the `ziglang` wheel makes its C++
library, which takes a minute or two; after this it is there for the first model.
"""

from __future__ import annotations

import asyncio
import subprocess
import sys
import tempfile
from pathlib import Path

from aos_protocol.errors import AosError
from aos_solver.compiler import find_compiler

PROGRAM = "#include <vector>\nint main() { return std::vector<int>(3).size() == 3 ? 0 : 1; }\n"
LIMIT_S = 900


def main() -> int:
    try:
        compiler = asyncio.run(find_compiler())
    except AosError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    with tempfile.TemporaryDirectory() as folder:
        source, thing, program = (str(Path(folder) / name) for name in ("try.cpp", "try.o", "try"))
        Path(source).write_text(PROGRAM)
        for command in (
            compiler.compilation(source, thing, folder),
            compiler.linking([thing], program),
            [program],
        ):
            done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
            if done.returncode != 0:
                sys.stderr.write(f"{compiler.version} cannot build a program:\n{done.stderr}{done.stdout}")
                return 2
    sys.stdout.write(f"{compiler.version}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
