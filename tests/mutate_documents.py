"""Mutated bundles through reader, checks and model generation: nothing may crash, and nothing may take long.

python tests/mutate_documents.py --count 50000 --seed 1

Each mutation changes one document of a bundle: some bytes, or words and lines as a careless editor would. Its
number and the seed give it again: --first NUMBER --count 1. Exit code 1 if a bundle crashed or was too slow.
"""

import argparse
import random
import re
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from aos_language.load import load_files, read_bundle_files
from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower

ROOT = Path(__file__).resolve().parents[1]
LIMIT_S = 1.0
WORD = re.compile(rb"\w+|[^\w\s]")
INTERESTING = tuple(
    text.encode("utf-8", "surrogateescape")
    for text in (
        *"{}[]()\"'\\#:;,\r\t\0",
        *("\udcff\udcfe", "\ufeff", "é😀", "/*", "//", 'R"x(', "#line 1\n"),
        *("__moduleResponse", "state__", "state_", "state", "AOS.Bernoulli(0.5)", "AOS.SampleDiscrete("),
        *("if (", "for (;;)", "return", "-1", "1e999", "99999999999999999999", "nan", "null", "true"),
        *("project: other\n", "response: \n", "code:\n"),
    )
)
"""Readers stumble over these texts."""

Bundle = dict[str, bytes]


class Findings:
    def __init__(self) -> None:
        self.outcomes: Counter[str] = Counter()
        self.failures: list[str] = []
        self.slow: list[str] = []  # apart from the failures, since no test may fail by a clock
        self.slowest_s = 0.0


def bundles_below(*folders: Path) -> list[Bundle]:
    """The bundles in these folders; a folder that is not there has none."""
    found = [
        path for folder in folders if folder.is_dir() for path in sorted(folder.iterdir()) if path.is_dir()
    ]
    bundles = [read_bundle_files(path)[0] for path in found]
    return [bundle for bundle in bundles if bundle]


def fuzz(
    bundles: list[Bundle], seed: int, first: int, count: int, on_progress: Callable[[int], None]
) -> Findings:
    """Reads so many mutations. Equal seeds and numbers give equal mutations."""
    findings = Findings()
    for number in range(first, first + count):
        draws = random.Random(f"{seed} {number}")
        bundle = dict(draws.choice(bundles))
        name = draws.choice(sorted(bundle))
        bundle[name] = _mutated(bundle[name], draws)
        began_s = time.process_time()
        try:
            findings.outcomes[_outcome(bundle)] += 1
        except Exception:
            findings.failures.append(f"mutation {number} of {name}:\n{traceback.format_exc(limit=-4)}")
        took_s = time.process_time() - began_s
        findings.slowest_s = max(findings.slowest_s, took_s)
        if took_s > LIMIT_S:
            findings.slow.append(f"mutation {number} of {name} took {took_s:.2f} s of processor time")
        on_progress(number - first + 1)
    return findings


def _outcome(bundle: Bundle) -> str:
    loaded = load_files(bundle)
    if loaded.project is None:
        assert loaded.has_errors, "no project, and nobody says why"
        return "refused by the checks"
    program, diagnostics = lower(loaded.project)
    if program is None:
        assert any(diagnostic.is_error for diagnostic in diagnostics)
        return "refused by the lowering"
    emit(program)
    return "accepted"


def _mutated(data: bytes, draws: random.Random) -> bytes:
    for _ in range(draws.choice((1, 1, 1, 2, 4))):
        data = draws.choice(_MUTATORS)(data, draws)
    return data


def _flip(data: bytes, draws: random.Random) -> bytes:
    at = draws.randrange(len(data) + 1)
    return data[:at] + bytes([draws.randrange(256)]) + data[at + 1 :]


def _insert(data: bytes, draws: random.Random) -> bytes:
    at = draws.randrange(len(data) + 1)
    word: bytes = draws.choice(INTERESTING)
    return data[:at] + word + data[at:]


def _cut(data: bytes, draws: random.Random) -> bytes:
    start = draws.randrange(len(data) + 1)
    return data[:start] + data[start + draws.choice((1, 2, 8, 64, len(data))) :]


def _repeat(data: bytes, draws: random.Random) -> bytes:
    start = draws.randrange(len(data) + 1)
    piece = data[start : start + draws.randrange(1, 200)]
    return data[:start] + piece * draws.choice((2, 3, 50)) + data[start:]


def _swap_words(data: bytes, draws: random.Random) -> bytes:
    words = list(WORD.finditer(data))
    if len(words) < 2:
        return data
    one, other = sorted(draws.sample(words, 2), key=lambda word: word.start())
    between = data[one.end() : other.start()]
    return data[: one.start()] + other[0] + between + one[0] + data[other.end() :]


def _replace_word(data: bytes, draws: random.Random) -> bytes:
    words = list(WORD.finditer(data))
    if not words:
        return data
    word = draws.choice(words)
    new = draws.choice(
        (b"", draws.choice(words)[0], draws.choice(INTERESTING), word[0][:-1], word[0] + word[0][-1:])
    )
    return data[: word.start()] + new + data[word.end() :]


def _move_line(data: bytes, draws: random.Random) -> bytes:
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    line = lines.pop(draws.randrange(len(lines)))
    for _ in range(draws.choice((0, 1, 1, 2))):
        lines.insert(draws.randrange(len(lines) + 1), line)
    return b"".join(lines)


_MUTATORS = (_flip, _insert, _cut, _repeat, _swap_words, _replace_word, _move_line)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first mutation")
    options = parser.parse_args()
    bundles = bundles_below(
        ROOT / "deploy/bundles", ROOT.parent / "shared/corpus", ROOT.parent / "shared/corpus/bad"
    )

    def progress(done: int) -> None:
        if done % 100 == 0 or done == options.count:
            sys.stderr.write(f"\r{done:,} of {options.count:,} mutations")

    began_s = time.perf_counter()
    findings = fuzz(bundles, options.seed, options.first, options.count, progress)
    sys.stderr.write("\n")
    figures = {
        "mutations": options.count,
        "bundles": len(bundles),
        "failures": len(findings.failures),
        "slow": len(findings.slow),
        "slowest_s": round(findings.slowest_s, 3),
        "seconds": round(time.perf_counter() - began_s, 1),
        **findings.outcomes,
    }
    found = findings.failures + findings.slow
    for failure in found[:20]:
        sys.stderr.write(f"{failure}\n")
    sys.stdout.writelines(f"{name.replace('_', ' ')}: {value}\n" for name, value in figures.items())
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
