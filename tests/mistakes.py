"""The seeded mistakes of tests/data/mistakes.toml: is each told, at its place?

python tests/mistakes.py [--json]

Prints in how many cases file and line are right, in how many the column is too, and every case that is not.
"""

import argparse
import json
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import msgspec
from marked_change import changed

from aos_language.load import load_files, read_bundle_files
from aos_protocol.diagnostics import Diagnostic, Span

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = re.compile(r"^```sdl ([^\n]+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Mistake(msgspec.Struct, frozen=True):
    """A bundle with one mistake in it, and the place and code of the finding that is due."""

    title: str
    files: dict[str, bytes]
    code: str
    place: Span


class Verdict(msgspec.Struct, frozen=True):
    """The reply of the checks to a mistake: the finding of the right code that is nearest to the place."""

    mistake: Mistake
    found: tuple[Diagnostic, ...]

    @property
    def has_line(self) -> bool:
        place = self.mistake.place
        return any(
            (finding.span.file, finding.span.line) == (place.file, place.line) for finding in self._of_code
        )

    @property
    def has_column(self) -> bool:
        return any(finding.span == self.mistake.place for finding in self._of_code)

    @property
    def _of_code(self) -> list[Diagnostic]:
        return [finding for finding in self.found if finding.code == self.mistake.code]


def mistakes() -> Iterator[Mistake]:
    table = tomllib.loads((ROOT / "tests/data/mistakes.toml").read_text(encoding="utf-8"))
    for bundle, rows in table.items():
        files = _bundle(bundle)
        for number, (file, code, change) in enumerate(rows, 1):
            after, place = changed(files, file, change)
            assert place.line, f"{bundle} {number} has no mark"
            yield Mistake(f"{bundle} {number}: {change.strip()}", after, code, place)


def judged(mistake: Mistake) -> Verdict:
    """Reads and checks the bundle as `aos lint --no-compile` does."""
    return Verdict(mistake, load_files(mistake.files).diagnostics)


def _bundle(name: str) -> dict[str, bytes]:
    if name == "sdl":
        page = (ROOT / "docs/languages.md").read_text(encoding="utf-8")
        return {file: body.encode() for file, body in EXAMPLE.findall(page)}
    example = "kettle-json" if name == "json" else name
    folders = (
        ROOT / "docs/examples" / example,
        ROOT / "deploy/bundles" / name,
        ROOT / "tests/data/bundles" / name,
    )
    files = read_bundle_files(next(folder for folder in folders if folder.is_dir()))[0]
    # The rough pick stands for the one of the documents that it adds to.
    return _bundle("armadillo-finer") | files if name == "armadillo-rough" else files


def main() -> int:
    """The command; exit code 1 where a line is wrong, or more than a twentieth of the columns."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="one JSON object with the figures")
    options = parser.parse_args()
    verdicts = [judged(mistake) for mistake in mistakes()]
    lines = sum(verdict.has_line for verdict in verdicts)
    columns = sum(verdict.has_column for verdict in verdicts)
    for verdict in verdicts:
        if not verdict.has_column:
            said = (
                "; ".join(f"{finding.span} {finding.code} {finding.message}" for finding in verdict.found)
                or "nothing"
            )
            due = f"{verdict.mistake.place} {verdict.mistake.code}"
            sys.stderr.write(f"{verdict.mistake.title}\n  due: {due}\n  said: {said}\n")
    figures = {"mistakes": len(verdicts), "right_line": lines, "right_column": columns}
    if options.json:
        sys.stdout.write(json.dumps(figures) + "\n")
    else:
        sys.stdout.write("".join(f"{name.replace('_', ' ')}: {value}\n" for name, value in figures.items()))
    return int(lines < len(verdicts) or columns < 0.95 * len(verdicts))


if __name__ == "__main__":
    sys.exit(main())
