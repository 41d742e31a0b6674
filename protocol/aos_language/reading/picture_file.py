"""A bundle's `picture.py`: Python that draws a state for the page. It is ours, and no document of AOS.

Here it is only read: that it is Python with a function `draw`. Whatever is wrong with it is a warning, since
no mission depends on it.
"""

import ast
import warnings

from aos_language.findings import Findings
from aos_language.python_syntax import module_of
from aos_language.reading.source import Source
from aos_protocol.diagnostics import Span

PICTURE = "picture.py"
DRAW = "draw"
_PARAMETERS = 3
_CODE = "AOS148"
_HINT = "Write `def draw(state, belief, step):`, which returns an SVG as text or a PNG as bytes"


def check_picture(source: Source, findings: Findings) -> None:
    """Adds what is wrong with the text of a `picture.py`."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            module = module_of(source.text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line, column = getattr(error, "lineno", None) or 1, getattr(error, "offset", None) or 1
        text = getattr(error, "msg", None) or str(error) or type(error).__name__
        findings.warning(_CODE, f"no valid Python: {text}", Span(PICTURE, line, max(column, 1)))
        return
    functions = [each for each in module.body if isinstance(each, ast.FunctionDef) and each.name == DRAW]
    if not functions:
        findings.warning(_CODE, "there is no function draw", Span(PICTURE, 1, 1), _HINT)
        return
    given = functions[-1].args
    required = len(given.args) + len(given.posonlyargs) - len(given.defaults)
    takes = len(given.args) + len(given.posonlyargs)
    is_callable = required <= _PARAMETERS and (takes >= _PARAMETERS or given.vararg is not None)
    needs_names = any(default is None for default in given.kw_defaults)
    if not is_callable or needs_names:
        span = Span(PICTURE, functions[-1].lineno, functions[-1].col_offset + 1)
        findings.warning(_CODE, "draw does not take a state, a belief and a step", span, _HINT)
