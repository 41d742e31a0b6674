"""The C++ compiler of this machine, and how it is called.

The first of these that is new enough counts: what $CXX names, g++, clang++, and the `ziglang` wheel, which
brings clang and a C++ library with it for machines without a compiler.
"""

import asyncio
import importlib.util
import os
import re
import shlex
import shutil
import sys
from collections.abc import Iterator, Mapping

import msgspec

from aos_protocol.errors import DeployError, ModelError
from aos_runtime.distribution import pip_install
from aos_runtime.processes.children import PIPE, Child

Family = str
"""`gcc`, `clang`, or `zig`, which is clang inside."""

_OLDEST = {"gcc": 11, "clang": 15}
_VERSION_TIMEOUT_S = 30.0
DEADLINE_S = 90.0
ZIG_DEADLINE_S = 600.0
_HINT = f"Install g++ 11 or newer (apt install g++), or the `ziglang` wheel ({pip_install('compiler')})"


class Compiler(msgspec.Struct, frozen=True):
    """A compiler that can build models. `version` is the first line that it says about itself."""

    command: tuple[str, ...]
    family: Family
    version: str

    def compilation(self, source: str, output: str, include: str, *more: str) -> list[str]:
        """The command that compiles a file.

        Messages read `file:line:column: error: text`; columns count bytes.
        """
        return [*self._command(include, *more), "-c", source, "-o", output]

    def _command(self, include: str, *more: str) -> list[str]:
        common = ["-std=c++20", "-O2", "-ffp-contract=off", "-fno-math-errno", "-w"]
        # A loop of a document that does not end shall be told, and not be left out as one that ends.
        common += ["-fno-finite-loops"]
        if self.family == "zig":
            # Zig adds checks and information for debuggers by itself.
            common += ["-fno-sanitize=all", "-g0"]
        # Code that divides an integer by zero shall crash. Compilers would assume that there is none.
        common += ["-fsanitize=integer-divide-by-zero"]
        if self.family == "gcc":
            common += ["-fsanitize-undefined-trap-on-error"]
            own = ["-Wno-narrowing", "-fdiagnostics-column-unit=byte", "-fdiagnostics-color=never"]
            own += ["-fno-diagnostics-show-caret", "-fmax-errors=40"]
            # Code that follows a draw is not copied for each outcome: a jump costs less than a wrong guess.
            own += ["--param=max-jump-thread-duplication-stmts=0"]
        else:
            common += ["-fsanitize-trap=integer-divide-by-zero"]
            own = ["-Wno-c++11-narrowing", "-fno-color-diagnostics", "-fno-caret-diagnostics"]
            # A null pointer shall crash where it is used, and not be optimised into a trap elsewhere.
            own += ["-ferror-limit=40", "-fno-delete-null-pointer-checks"]
        return [*self.command, *common, *own, *more, "-I", include]

    @property
    def large_source(self) -> tuple[str, ...]:
        """The options for the engine, most of which runs seldom: the second level takes a quarter longer.

        Its searches by POMCP ask for that level themselves (tree_search.hpp). Clang does not know how to.
        It takes more memory and a tenth less time where gcc does not collect garbage.
        """
        more = ("-finline-small-functions", "-findirect-inlining", "-fstrict-aliasing")
        return ("-O1", *more, *self.without_collections) if self.family == "gcc" else ()

    @property
    def largest_source(self) -> tuple[str, ...]:
        """The options for the part that holds states: without passes that take a tenth of its time."""
        less = ("-fno-tree-pta", "-fno-tree-dominator-opts", "-fno-ipa-modref", "-fno-tree-dse")
        return (*self.large_source, *less, "-fira-region=one") if self.family == "gcc" else ()

    @property
    def without_collections(self) -> tuple[str, ...]:
        """The option with which gcc collects garbage in very large sources only."""
        return ("--param=ggc-min-heapsize=600000",) if self.family == "gcc" else ()

    def precompilation(self, header: str, include: str, directory: str, *more: str) -> list[str]:
        """The command that reads a header for all files that include it first.

        The result is put below the directory, in the header's folders. A compilation finds it there that
        has the same options `more` and those of `precompiled`.
        """
        suffix = "gch" if self.family == "gcc" else "pch"
        # Clang would refuse the result once the header has been written anew, even with the same text.
        own = [] if self.family == "gcc" else ["-Xclang", "-fno-pch-timestamp"]
        language = ["-x", "c++-header", f"{include}/{header}"]
        return [*self._command(include, *more, *own), *language, "-o", f"{directory}/{header}.{suffix}"]

    def precompiled(self, header: str, directory: str) -> list[str]:
        """The options that make a compilation use a header precompiled in a directory.

        Gcc reads the header itself where the precompiled one does not fit. Clang wants the header to be still
        where it was.
        """
        return ["-I", directory] if self.family == "gcc" else ["-include", f"{directory}/{header}"]

    def linking(self, objects: list[str], output: str) -> list[str]:
        """The command that links object files into an executable, with the quickest linker that is there."""
        is_gold_there = self.family == "gcc" and shutil.which("ld.gold") is not None
        quickest = ["-fuse-ld=gold"] if is_gold_there else []
        return [*self.command, *quickest, *objects, "-o", output]

    @property
    def deadline_s(self) -> float:
        """The time that one command may take; zig builds its C++ library when it links for the first time."""
        return ZIG_DEADLINE_S if self.family == "zig" else DEADLINE_S


async def find_compiler(environment: Mapping[str, str] = os.environ) -> Compiler:
    """The first compiler that is new enough; ModelError AOS203 if there is none."""
    reasons: list[str] = []
    for command in _candidates(environment):
        compiler, reason = await _examine(command)
        if compiler is not None:
            return compiler
        reasons.append(reason)
        if environment.get("CXX") and command == tuple(shlex.split(environment["CXX"])):
            raise ModelError(f"CXX is set, but {reason}", code="AOS203", hint="Unset CXX or mend it")
    found = f": {'; '.join(reasons)}" if reasons else ""
    raise ModelError(f"no C++ compiler to build the model with{found}", code="AOS203", hint=_HINT)


def _candidates(environment: Mapping[str, str]) -> Iterator[tuple[str, ...]]:
    if environment.get("CXX"):
        yield tuple(shlex.split(environment["CXX"]))
    for name in ("g++", "clang++"):
        if shutil.which(name, path=environment.get("PATH")):
            yield (name,)
    if importlib.util.find_spec("ziglang") is not None:
        yield (sys.executable, "-m", "ziglang", "c++")


async def _examine(command: tuple[str, ...]) -> tuple[Compiler | None, str]:
    """The compiler, or why it cannot be used."""
    name = shlex.join(command)
    try:
        child = await Child.start([*command, "--version"], stdout=PIPE, stderr=asyncio.subprocess.DEVNULL)
    except DeployError as error:
        return None, error.message
    try:
        async with asyncio.timeout(_VERSION_TIMEOUT_S):
            text = (await child.stdout.read()).decode(errors="replace")
            status = await child.wait()
    except TimeoutError:
        return None, f"{name} does not answer"
    finally:
        await child.stop()
    if status != 0 or not text.strip():
        return None, f"{name} does not run"
    line = text.splitlines()[0].strip()
    family = "zig" if "ziglang" in command or " zig" in name else "clang" if "clang" in text else "gcc"
    major = re.search(r"\b(\d+)\.\d+", line.removeprefix("g++").split(")")[-1] or line)
    oldest = _OLDEST["gcc" if family == "gcc" else "clang"]
    if major is not None and int(major[1]) < oldest:
        return None, f"{name} is too old ({line}; {oldest} is needed)"
    return Compiler(command, family, line), ""
