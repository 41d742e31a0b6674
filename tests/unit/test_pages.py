import importlib
import re
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

PAGES = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]
DIARIES = ("CHANGELOG.md", "docs/lab/", "docs/decisions/", "docs/experiments/")
"""Pages whose measurements, decisions and reports belong to a date."""
FENCED = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
INLINE_CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#{1,6} (.+)$", re.MULTILINE)
FIGURES = re.compile(r"<!-- figures -->.*?<!-- end -->", re.DOTALL)
DATE = re.compile(r"20\d\d-\d\d-\d\d")


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@cache
def anchors(page: Path) -> frozenset[str]:
    """The anchors of a page's headings, as code hosts make them."""
    found: list[str] = []
    for heading in HEADING.findall(FENCED.sub("", page.read_text(encoding="utf-8"))):
        text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
        found.append(f"{anchor}-{found.count(anchor)}" if anchor in found else anchor)
    return frozenset(found)


def local_links(page: Path) -> list[str]:
    text = INLINE_CODE.sub("", FENCED.sub("", page.read_text(encoding="utf-8")))
    return [link for link in LINK.findall(text) if not re.match(r"\w+:", link)]


def is_broken(page: Path, link: str) -> bool:
    path, _, anchor = link.partition("#")
    target = (page.parent / path).resolve() if path else page
    if not target.exists() or not target.is_relative_to(ROOT):
        return True
    return bool(anchor) and target.suffix == ".md" and anchor not in anchors(target)


def test_every_link_of_a_page_leads_to_a_file_and_a_heading_that_are_there():
    broken = [
        f"{name_of(page)}: {link}" for page in PAGES for link in local_links(page) if is_broken(page, link)
    ]
    assert broken == []


def test_a_link_to_a_file_or_heading_that_is_not_there_is_found():
    page = ROOT / "docs" / "README.md"
    links = [
        "limits.md#missions",
        "#you-work-on-aos",
        "nowhere.md",
        "limits.md#nowhere",
        "#nowhere",
        "../../x",
    ]
    assert [link for link in links if is_broken(page, link)] == links[2:]


def test_no_table_is_cut_by_an_empty_line():
    """The rest of such a table has no head, and is shown as text."""
    cut = re.compile(r"^\|.*\n\n+\|.*\n(?!\|[ :|-]+\|$)", re.MULTILINE)
    texts = {page: FENCED.sub("", page.read_text(encoding="utf-8")) for page in PAGES}
    assert [name_of(page) for page, text in texts.items() if cut.search(text)] == []
    assert cut.search("| a |\n| --- |\n| b |\n\n| c |\n")


def test_pages_of_reference_have_a_date_only_at_the_head_of_their_figures():
    dated = []
    for page in PAGES:
        if not name_of(page).startswith(DIARIES):
            text = page.read_text(encoding="utf-8")
            dated += [
                f"{name_of(page)}: {line}" for line in FIGURES.sub("", text).splitlines() if DATE.search(line)
            ]
            figures = FIGURES.findall(text)
            assert [len(DATE.findall(table)) for table in figures] in ([], [1]), name_of(page)
    assert dated == []


def test_the_index_leads_to_every_page():
    """The index has a link to a page itself, or to the list of its folder."""
    index = ROOT / "docs" / "README.md"
    linked = {(index.parent / link.partition("#")[0]).resolve() for link in local_links(index)}
    folders = {page.parent for page in linked if page.name == "README.md"}
    pages = [page for page in PAGES if page.parent != ROOT and page != index]
    assert [name_of(page) for page in pages if page not in linked and folders.isdisjoint(page.parents)] == []


def test_the_laboratory_lists_every_page_of_its_own():
    listed = [ROOT / "docs/lab" / link for link in local_links(ROOT / "docs/lab/README.md")]
    assert sorted(listed) == [
        page for page in PAGES if page.parent.name == "lab" and page.name != "README.md"
    ]


def test_a_measured_table_takes_the_place_of_the_old_one_alone(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    figures = importlib.import_module("figures")
    page = tmp_path / "page.md"
    monkeypatch.setattr(figures, "DOCS", tmp_path)
    page.write_text("before\n<!-- figures -->\nold\n<!-- end -->\nafter\n")
    figures.paste("new", page)
    assert page.read_text() == "before\n<!-- figures -->\nnew\n\n<!-- end -->\nafter\n"
    page.write_text("no place")
    with pytest.raises(SystemExit, match="no place for figures"):
        figures.paste("new", page)


def test_every_page_that_can_be_measured_has_a_place_for_it(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    measured = importlib.import_module("figures").FIGURES
    with_figures = [page.stem for page in PAGES if FIGURES.search(page.read_text(encoding="utf-8"))]
    assert sorted(measured) == with_figures
