"""The Python of documents as trees, and what parses although it was meant otherwise."""

import ast
import keyword
import re
import warnings

from aos_language.findings import Findings
from aos_language.python_syntax import tree_of
from aos_protocol.diagnostics import Mend
from aos_protocol.documents import Snippet
from aos_protocol.spelling import column_of

_OTHER_OPERATOR = re.compile(r"&&|\|\||!(?!=)|\b(?:AND|OR|NOT)\b")
_COUNTED = re.compile(r"(\w+)([-+])\2")
_TURNED = re.compile(r"=([<>])(?!=)")
_LINE = re.compile(r"(?<=(?:on|at) line )\d+")
_TEXT = re.compile(r"'[^'\n]*'|\"[^\"\n]*\"|#.*")


def parsed(snippet: Snippet, mode: str, findings: Findings) -> ast.AST | None:
    """The syntax tree; None, with an error at its place, where it is not Python."""
    code = snippet.code
    is_long = mode == "eval" and "\n" in code  # An expression may go on in the next line.
    # What closes one kind of brackets and opens it again does not pass in the other.
    texts = (f"(\n{code}\n)", f"[\n{code}\n]") if is_long else (code,)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree, *_ = [tree_of(text, mode) for text in texts]
            tree = ast.increment_lineno(tree, -1) if is_long else tree
    except SyntaxError as error:
        # Python gives no column where the code ends too early.
        end = len(code) - (code.rfind("\n") + 1) + 1
        span = snippet.locate((error.lineno or 1) - is_long, error.offset or end)
        message = _LINE.sub(lambda n: str(snippet.locate(int(n[0]) - is_long, 1).line), error.msg)
        wrong = (error.text or "")[(error.offset or end) - 1 : error.end_offset and error.end_offset - 1]
        if error.msg == "invalid syntax":
            message = f"`{wrong}` cannot stand here" if wrong.strip() else "something is missing here"
        hint = _instead(_TEXT.sub("", code), wrong, mode)
        findings.error("AOS121", f"this is not Python: {message}", span, hint)
    except (ValueError, RecursionError, MemoryError) as error:
        findings.error("AOS121", f"this cannot be read as Python: {error}", snippet.span)
    else:
        _check_lone_commas(snippet, tree, findings)
        _check_bit_operators(snippet, tree, findings)
        return tree
    return None


def _instead(code: str, wrong: str, mode: str) -> str:
    """Advice on what Python cannot read; empty where there is none."""
    if (turned := _TURNED.search(code)) is not None:
        return f"Python writes `{turned[1]}=`"
    if (counted := _COUNTED.search(code)) is not None:
        return f"Python writes `{counted[1]} {counted[2]}= 1`"
    if "else if" in code:
        return "Python writes `elif`"
    if _OTHER_OPERATOR.search(code):
        return "Python writes `and`, `or`, `not`"
    if mode != "eval":
        return ""
    if wrong == "=":
        return "To compare, write `==`"
    if wrong == "?":
        return "Python writes `a if condition else b`"
    if wrong in (";", ":") or (keyword.iskeyword(wrong) and code.lstrip().startswith(wrong)):
        return f"This is one expression: leave `{wrong}` out"
    is_value = wrong[:1].isalnum() and not keyword.iskeyword(wrong)
    return "Between two values stands an operator, such as `and` or `==`" if is_value else ""


def _check_lone_commas(snippet: Snippet, tree: ast.AST, findings: Findings) -> None:
    """Warns where a comma at the end makes a value a tuple of one, which is always true."""
    for node in ast.walk(tree):
        match node:
            case (
                ast.Expression(body=ast.Tuple(elts=[only]) as value)
                | ast.Assign(value=ast.Tuple(elts=[only]) as value)
                | ast.Return(value=ast.Tuple(elts=[only]) as value)
            ) if value.lineno < 1 or value.col_offset == only.col_offset:
                line = only.end_lineno or only.lineno
                text = snippet.code.split("\n")[line - 1]
                comma = text.find(",", column_of(text, only.end_col_offset or 0) - 1)
                span = snippet.locate(line, comma + 1)
                message = "the comma at the end makes this a tuple, which is always true"
                findings.warning(
                    "AOS149", message, span, "Leave it out", Mend(span, 1, "") if comma >= 0 else None
                )


def _check_bit_operators(snippet: Snippet, tree: ast.AST, findings: Findings) -> None:
    """Warns of `a > 4 & b`, which compares `a` with `4 & b`."""
    lines = snippet.code.split("\n")
    for node in ast.walk(tree):
        if not isinstance(node, ast.Compare):
            continue
        for place, part in enumerate(node.comparators):
            match part:
                case ast.BinOp(op=ast.BitAnd() | ast.BitOr() as op, left=left):
                    line, column = part.lineno, column_of(lines[part.lineno - 1], part.col_offset)
                    is_bare = not lines[line - 1][: column - 1].rstrip().endswith("(")
                    is_middle = place + 1 < len(node.comparators)
                    if is_bare and (is_middle or isinstance(left, ast.Constant | ast.BinOp)):
                        sign, word = ("&", "and") if isinstance(op, ast.BitAnd) else ("|", "or")
                        message = (
                            f"`{sign}` binds before the comparison: this compares with `{ast.unparse(part)}`"
                        )
                        findings.warning("AOS149", message, snippet.locate(line, column), f"Write `{word}`")
