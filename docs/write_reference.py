"""Writes what follows from the sources: errors.md, the notebook, tables of other pages.

`python docs/write_reference.py` writes them, `--check` only says whether they are current (exit code 1 if
not). In http-api.md, languages.md, limits.md and protocol.md the text between `<!-- generated: NAME -->` and
`<!-- end -->` is replaced; the rest is written by hand.
"""

import json
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from limits_table import limits_table

from aos_deploy.exit_codes import EXIT_CODES_TEXT
from aos_gateway.api.app import OPERATIONS
from aos_language.reading.sdl_text import Word
from aos_language.reading.sdl_words import GRAMMARS
from aos_protocol import access, errors, keys

DOCS = Path(__file__).resolve().parent
GENERATED = re.compile(r"(<!-- generated: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


# --- errors ---


def errors_page() -> str:
    """Every code under the exception that carries it, by the drawing in `errors`; then the exit codes."""
    lines = [
        "# Error codes",
        "",
        "Every fault and every finding about a document has a code, which crosses the bus and stands in the",
        "journal. `make docs` writes this page from `aos_protocol.errors.CODES` and `aos_deploy.exit_codes`.",
    ]
    for digit, (name, situation) in error_classes().items():
        lines += ["", f"## {name}: {situation}", ""]
        lines += [f"- {code}: {text}" for code, text in errors.CODES.items() if code[3] == digit]
    lines += ["", "## Exit codes of aos and aos-up", ""]
    lines += [f"- {code}: {text}" for code, text in exit_codes()]
    return "\n".join(lines) + "\n"


def error_classes() -> dict[str, tuple[str, str]]:
    """First digit of a code -> class name and what it is for."""
    drawn = re.findall(r"^ +(\w+) +AOS(\d)xx  (.+)$", errors.__doc__ or "", re.MULTILINE)
    return {digit: (name, situation) for name, digit, situation in drawn}


def exit_codes() -> list[tuple[str, str]]:
    """(number, meaning), as the commands' help texts tell them."""
    return re.findall(r"(\d+) (.+?)(?=, \d+ |\.$)", EXIT_CODES_TEXT)


# --- keys ---


def key_rows() -> Iterator[tuple[str, str, str, str]]:
    """(key, kind, what for, messages) of each line of the table in `keys`."""
    for line in (keys.__doc__ or "").splitlines():
        if not line.startswith("    aos/"):
            continue
        key, kind, *rest = re.split(r"\s{2,}|: ", line.strip())
        what, said = (*rest, "")[:2]
        yield key, kind, what, said


def key_table() -> str:
    lines = ["| Key | Kind | What for | Message |", "| --- | --- | --- | --- |"]
    for key, kind, what, said in key_rows():
        lines.append(f"| `{key}` | {kind} | {what} | {said.replace('->', '→')} |")
    return "\n".join(lines) + "\n"


# --- notebook ---


def notebook(page: str) -> str:
    """The part of a page that is a notebook, as one: its blocks of Python are cells, and its prose others."""
    part = page.split("<!-- notebook -->")[1].split("<!-- end -->")[0]
    pieces = re.split(r"```python\n(.*?)```\n", part, flags=re.DOTALL)
    cells: list[dict[str, object]] = []
    for place, piece in enumerate(pieces):
        if text := piece.strip("\n"):
            of_code = {"execution_count": None, "outputs": []} if place % 2 else {}
            kind = "code" if place % 2 else "markdown"
            source = text.splitlines(keepends=True)
            cells.append(
                {"cell_type": kind, "id": f"cell-{len(cells)}", "metadata": {}, "source": source, **of_code}
            )
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    whole = {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


# --- http ---


def operation_table() -> str:
    """The operations of the gateway; its OpenAPI document has what each takes and gives."""
    lines = ["| Operation | What it does |", "| --- | --- |"]
    lines += [f"| `{one.method} {one.path}` | {one.summary.rstrip('.')} |" for one in OPERATIONS]
    return "\n".join(lines) + "\n"


# --- access ---


def access_table() -> str:
    """The table of who may do what, a line for each key; a token is told by who announces it."""
    lines = ["| Key | asks → answers | tells → hears |", "| --- | --- | --- |"]
    for row in access.TABLE:
        asked = _way(row.asks, row.answers)
        told = _way(row.tells or row.announces, row.hears or row.watches)
        lines.append(f"| `{row.key}` | {asked} | {told} |")
    return "\n".join(lines) + "\n"


def _way(sender: tuple[str, ...], receiver: tuple[str, ...]) -> str:
    return f"{_roles(sender)} → {_roles(receiver)}" if sender else ""


def _roles(roles: tuple[str, ...]) -> str:
    return "all" if roles == access.ROLES else ", ".join(roles)


# --- words ---


def words_lists() -> str:
    """Every word of SDL by kind of file, with the texts that editors show, but for those without effect.

    A word of all files stands in the first list, and parts of several sections below the first of them.
    """
    lines: list[str] = []
    before: dict[str, Word] = {}
    for suffix, sections in GRAMMARS.items():
        lines += [f"### Words of `{suffix}`", ""]
        for name, word in sections.items():
            if before.get(name) == word:
                continue
            same = next(
                (
                    known
                    for known, other in before.items()
                    if other.parts and other.parts.items() <= word.parts.items()
                ),
                "",
            )
            own = [
                f"  - `{part}`: {inner.meaning}"
                for part, inner in word.parts.items()
                if (not same or part not in before[same].parts) and "has no effect" not in inner.meaning
            ]
            parts_of = f" (parts of `{same}`)" if same else ""
            lines += [f"- `{name}`{parts_of}: {word.meaning}", *own]
            before.setdefault(name, word)
        lines.append("")
    return "\n".join(lines) + "\n"


# --- pages ---


def with_generated_parts(current: str) -> str:
    """The page with its generated parts renewed."""
    parts = {
        "http": operation_table,
        "keys": key_table,
        "access": access_table,
        "limits": limits_table,
        "words": words_lists,
    }
    return GENERATED.sub(lambda match: f"{match[1]}\n{parts[match[2]]()}\n{match[3]}", current)


def pages() -> dict[Path, str]:
    """The text that each page should have."""
    generated_in_part = [DOCS / name for name in ("http-api.md", "languages.md", "limits.md", "protocol.md")]
    return {
        DOCS / "errors.md": errors_page(),
        DOCS / "notebook.ipynb": notebook((DOCS / "python.md").read_text(encoding="utf-8")),
        **{page: with_generated_parts(page.read_text(encoding="utf-8")) for page in generated_in_part},
    }


def main() -> int:
    stale = [
        (page, text)
        for page, text in pages().items()
        if not page.exists() or page.read_text(encoding="utf-8") != text
    ]
    if "--check" in sys.argv[1:]:
        for page, _ in stale:
            sys.stderr.write(f"{page.relative_to(DOCS.parent)} is not current: run `make docs`\n")
        return 1 if stale else 0
    for page, text in stale:
        page.write_text(text, encoding="utf-8")
        sys.stdout.write(f"{page.relative_to(DOCS.parent)} written\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
