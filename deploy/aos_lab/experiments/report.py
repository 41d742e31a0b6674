"""The report of an experiment: Markdown for pages and repositories, and one HTML file to send to others."""

import html
from base64 import b64encode
from collections.abc import Iterator, Mapping
from pathlib import Path

from aos_lab.experiments.markdown import ends, head, row, shown, tally
from aos_lab.experiments.markdown import page as page_of
from aos_lab.experiments.results import Results
from aos_lab.trials.claims import Verdict, usual_share

_SHOWN_SEEDS = 20


def write_report(results: Results, plots: Mapping[str, Path], folder: Path) -> tuple[Path, Path]:
    """`report.md`, with links to pictures of the world, and `report.html`, with them and the drawings."""
    page, whole = folder / "report.md", folder / "report.html"
    page.write_text(markdown_report(results))
    pictures = "".join(f"<h3>{html.escape(title)}</h3>{_svg(path)}" for title, path in plots.items())
    for part in results.parts:
        if part.picture:
            pictures += f"<h3>{html.escape(part.name)}</h3>{_embedded(folder / part.picture)}"
    whole.write_text(page_of(results.title, markdown_report(results, has_pictures=False), pictures))
    return page, whole


def _embedded(path: Path) -> str:
    return f'<img alt="the world" src="data:image/webp;base64,{b64encode(path.read_bytes()).decode()}">'


def _svg(path: Path) -> str:
    """The drawing alone, without the lines that only a file of its own has."""
    text = path.read_text()
    return text[text.index("<svg") :]


def markdown_report(results: Results, *, has_pictures: bool = True) -> str:
    """The report, with links to pictures of the world; drawings show what its tables say."""
    around = results.surroundings
    lines = [f"# {results.title}", ""]
    if results.about:
        lines += [results.about.strip(), ""]
    lines += [around.text(results.command), ""]
    lines += ["## Claims", "", _WANTED, "", *_claims(results), "", "## Figures", "", *_figures(results), ""]
    lines += ["Steps of a mission, and how missions ended and began:", "", *_doings(results), ""]
    if any(part.regret or part.no_optimum for part in results.parts):
        lines += ["## Beside the optimum", "", _REGRET, "", *_regrets(results), ""]
    lines += ["Values in brackets are the ends of 95 % intervals.", ""]
    for part in results.parts if has_pictures else ():
        if part.picture:
            lines += [f"![{part.name}: the world at the end of a mission]({part.picture})", ""]
    if broken := list(_broken(results)):
        lines += ["## Missions that broke", "", *broken, ""]
    return "\n".join(lines)


def _claims(results: Results) -> Iterator[str]:
    """A row for each claim of a part, with the verdicts of all who played it beside each other."""
    players = list(dict.fromkeys(part.by for part in results.parts))
    cells: dict[tuple[str, str], dict[str, str]] = {}
    for part in results.parts:
        for verdict in part.verdicts:
            cells.setdefault((part.name, verdict.says), {})[part.by] = _cell(verdict, part.by)
    yield from head("part", "claim", *(f"played by {player}" for player in players))
    for (name, says), by in cells.items():
        yield row(name, says, *(by.get(player, "") for player in players))


def _cell(verdict: Verdict, by: str) -> str:
    word = verdict.word if verdict.is_seen else f"**{verdict.word}**"
    text = f"{word}: {verdict.held} of {verdict.missions} {ends(verdict.share)}"
    if verdict.wanted != usual_share(by):
        text += f", wanted {verdict.wanted:.2f}"
    return text + (f", not in seeds {_first_of(verdict.failed_seeds)}" if verdict.failed_seeds else "")


_WANTED = (
    f"Wanted is that a claim holds in {usual_share('model'):.2f} of the missions that the model plays and in "
    f"{usual_share('system'):.2f} of those of a system, unless another share is named."
)
_REGRET = (
    "The optimum is the best that a mission can bring on average, between SARSOP's proven bounds: the value "
    "of the initial belief, discounted, without a limit of steps. Where the deploy file has a "
    "`stop_below_value`, the robot may stop at any time, and stopping is worth that much; it is counted in "
    "the returns here, too, of missions that stopped. What is missing to the optimum is a share of the "
    "range, the difference between the largest and the smallest of these returns. Below 0 the missions "
    "brought more, by chance or because they end where the belief is sure enough."
)


def _regrets(results: Results) -> Iterator[str]:
    yield from head(
        "part",
        "missions",
        "return, with what stopping is worth",
        "stopping is worth",
        "optimum",
        "range",
        "missing, as a share of the range",
    )
    for part in results.parts:
        if part.no_optimum:
            yield row(part.name, str(part.figures.missions), "", "", part.no_optimum, "", "")
        if (regret := part.regret) is not None:
            optimum = regret.optimum
            yield row(
                part.name,
                str(part.figures.missions),
                shown(regret.value),
                "" if optimum.stop_value is None else f"{optimum.stop_value:g}",
                f"{optimum.lower:.3f} to {optimum.upper:.3f}",
                f"{regret.scale:.2f}",
                shown(regret.share, 3),
            )


def _first_of(seeds: tuple[int, ...]) -> str:
    """The first ones; report.json has all."""
    listed = ", ".join(map(str, seeds[:_SHOWN_SEEDS]))
    return f"{listed} and {len(seeds) - _SHOWN_SEEDS} more" if len(seeds) > _SHOWN_SEEDS else listed


def _figures(results: Results) -> Iterator[str]:
    goal, in_world, speed = "goal reached", "reached in the world", "simulated seconds a second"
    yield from head("part", "played by", "missions", goal, in_world, "return", "steps", speed)
    for part in results.parts:
        figures = part.figures
        yield row(
            part.name,
            part.by,
            str(figures.missions) + (f" ({figures.broken} broke)" if figures.broken else ""),
            shown(figures.goal),
            shown(figures.world_goal),
            shown(figures.value),
            shown(figures.steps),
            f"{figures.speed:.1f}" if figures.speed is not None else "",
        )


def _doings(results: Results) -> Iterator[str]:
    """A table of its own, so that none is wider than a page."""
    counted = sorted({name for part in results.parts for name in part.figures.counts})
    yield from head("part", "played by", *counted, "endings", "first")
    for part in results.parts:
        figures = part.figures
        yield row(
            part.name,
            part.by,
            *(shown(figures.counts.get(name)) for name in counted),
            tally(figures.endings),
            tally(figures.first_actions),
        )


def _broken(results: Results) -> Iterator[str]:
    for part in results.parts:
        for seed, fault in part.broken.items():
            yield f"- {part.name}, {part.by}, seed {seed}: {fault}"
