import ast
import re
import subprocess
from collections.abc import Iterator
from itertools import pairwise

import pytest
from places import ROOT

FRAGMENTS = re.compile(
    r"(about|after|as|at|back|before|below|beside|between|by|for|from|how|in|kept|not|of|on|out|that|to|told"
    r"|until|up|what|when|where|whether|which|who|whom|whose|why|with|within|without)\b"
    r"|AOS\d+|\w+Error\b",
    re.IGNORECASE,
)
"""A docstring that begins with one of these words, or with an error, has its verb somewhere else, or none."""

_SENTENCE_ENDS = (".", "?", ":")


def docstrings(node: ast.AST) -> Iterator[tuple[int, str]]:
    """Yields line and text: those of modules, classes and functions, and texts below an assignment."""
    owner = (
        node if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) else None
    )
    for name in ("body", "handlers", "orelse", "finalbody", "cases"):
        for before, statement in pairwise([owner, *getattr(node, name, ())]):
            match statement:
                case ast.Expr(value=ast.Constant(value=str(text))):
                    if before is owner is not None or isinstance(before, ast.Assign | ast.AnnAssign):
                        yield statement.lineno, text
                case _:
                    yield from docstrings(statement)


def fault_of(text: str) -> str:
    """Returns what is wrong with the beginning of a docstring; empty where nothing is."""
    paragraph = " ".join(re.split(r"\n\s*\n", text.strip())[0].split())
    if fragment := FRAGMENTS.match(paragraph):
        return f'begins with "{fragment[0]}": begin with a verb or a noun'
    if not paragraph.endswith(_SENTENCE_ENDS):
        return "does not end its first paragraph as a sentence"
    return ""


@pytest.mark.parametrize(
    ("text", "is_right"),
    [
        ("Returns the sum.", True),
        ("The sum of both:\n\n    1 + 1", True),
        ("Whether it holds.", False),
        ("Of both, the larger one.", False),
        ("whether it holds.", False),
        ("DeployError if it is missing.", False),
        ("Raises DeployError if it is missing.", True),
        ("Returns the sum", False),
        ("", False),
    ],
)
def test_fragments_are_told_from_sentences(text, is_right):
    assert (not fault_of(text)) is is_right


def test_docstrings_of_every_kind_are_found():
    source = '"""One."""\nx = 1\n"""Two."""\nclass A:\n    """Three."""\n    y: int = 0\n    """Four."""\n'
    source += (
        '    def f(self):\n        """Five."""\n        self.z = 1\n        """Six."""\nprint(x)\n"""0"""\n'
    )
    found = sorted(docstrings(ast.parse(source)))
    assert [text for _, text in found] == ["One.", "Two.", "Three.", "Four.", "Five.", "Six."]


def test_every_docstring_begins_with_a_whole_sentence():
    names = subprocess.run(
        ["git", "ls-files", "-z", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\0")
    files = [ROOT / name for name in names if name and (ROOT / name).is_file()]
    assert len(files) > 100
    faults = [
        f'{file.relative_to(ROOT)}:{line}: {fault}: "{text.strip().splitlines()[0] if text.strip() else ""}"'
        for file in files
        for line, text in docstrings(ast.parse(file.read_text("utf-8")))
        if (fault := fault_of(text))
    ]
    assert not faults, "docstrings whose first sentence is none:\n" + "\n".join(faults)
