"""Pieces of Markdown that reports are made of, and the page that it makes."""

import html
import math
from collections.abc import Iterator, Mapping

from markdown_it import MarkdownIt

from aos_lab.trials.intervals import Interval

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:66em;margin:2em auto;padding:0 1em}"
    "table{display:block;overflow-x:auto;border-collapse:collapse;margin:1em 0;font-size:.9em}"
    "th,td{border:1px solid #ccc;padding:.2em .45em;vertical-align:top}"
    "th{background:#f3f3f3}svg,img{max-width:100%;height:auto}code{background:#f3f3f3}"
)


def page(title: str, markdown: str, after: str = "") -> str:
    """One HTML file; `after` is HTML that follows the text."""
    text = MarkdownIt("commonmark", {"html": False}).enable("table").render(markdown)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f"</title><style>{_STYLE}</style></head><body>{text}{after}</body></html>\n"
    )


def head(*names: str) -> Iterator[str]:
    """The two first lines of a table."""
    yield row(*names)
    yield row(*("---" for _ in names))


def row(*cells: str) -> str:
    """A line of a table."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def shown(interval: Interval | None, digits: int = 2) -> str:
    """`0.95 [0.90, 0.98]`, without ends where none are known or both are the same; or nothing."""
    if interval is None:
        return ""
    value = f"{interval.value:.{digits}f}"
    has_ends = interval.low < interval.high and not math.isinf(interval.low)
    return f"{value} {ends(interval, digits)}" if has_ends else value


def ends(interval: Interval, digits: int = 2) -> str:
    return f"[{interval.low:.{digits}f}, {interval.high:.{digits}f}]"


def tally(counts: Mapping[str, int]) -> str:
    """`goal 9, failure 1`."""
    return ", ".join(f"{name} {count}" for name, count in counts.items())
