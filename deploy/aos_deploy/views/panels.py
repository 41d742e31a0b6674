"""The parts of the live screen: steps, values of actions, belief; each within a width and some rows."""

import re
from collections.abc import Iterable

from rich.table import Table
from rich.text import Text

from aos_deploy.views.lines import observation_text
from aos_deploy.views.values import Digits, by_worth, proven_texts
from aos_protocol.chances import chance_text
from aos_protocol.messages import BeliefSummary, DecisionRecord, Marginal, SkillProgress

_BAR_CELLS = 20
_PROGRESS_CELLS = 10
_SHOWN_VALUES = 4
_WIDE = 100
_BOUNDS_CELLS = 24
_STEP_COLUMNS_CELLS = 36
"""The width of the step table without its action and its observation, which have _ROOM_CELLS at least."""
_ROOM_CELLS = 20
_WIDE_ROOM_CELLS = 3 * len("observation")
_LEFT_OUT_CELLS = {"surprise": 10, "value": 9}
"""Columns of the step table that a narrow terminal goes without, in this order."""
_PARAMETER_NAME = re.compile(r"(?<=[(,])( ?)\w+=")


def brief_action(action: str) -> str:
    """`navigate(destination=corridor)` as `navigate(corridor)`."""
    return _PARAMETER_NAME.sub(r"\1", action)


def step_table(records: Iterable[DecisionRecord], width: int) -> Table:
    """A row for each step: what was chosen and what came of it."""
    records = tuple(records)
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    columns = ["step", "action", "value", "observation", "surprise", "goal"]
    room = width - _STEP_COLUMNS_CELLS
    for column, freed in _LEFT_OUT_CELLS.items():
        if room < _ROOM_CELLS:
            columns.remove(column)
            room += freed
    for column in columns:
        is_number = column in ("step", "value", "surprise", "goal")
        header = "seen" if column == "observation" and room < _WIDE_ROOM_CELLS else column
        table.add_column(header, justify="right" if is_number else "left", no_wrap=True)
    room = max(room, _ROOM_CELLS)
    actions = _fitting([record.action for record in records], room * 2 // 3)
    values = [_chosen_value(record) for record in records]
    digits = Digits.of((value for value in values if value is not None), 2)
    for record, action, value in zip(records, actions, values, strict=True):
        observation = _observation(record)
        observation.truncate(max(room - max(map(len, actions)), room // 3), overflow="ellipsis")
        cells: dict[str, str | Text] = {
            "step": str(record.step),
            "action": action,
            "value": "" if value is None else digits.signed(value),
            "observation": observation,
            "surprise": "" if record.outcome is None else f"{record.surprise:.2f}",
            "goal": chance_text(record.belief.goal_probability),
        }
        table.add_row(*(cells[column] for column in columns))
    return table


def _chosen_value(record: DecisionRecord) -> float | None:
    return next((value.q for value in record.actions if value.action == record.action), None)


def value_table(record: DecisionRecord, width: int, rows: int) -> Table:
    """Shows the values of the actions, the best first; the last row tells how many are not shown.

    What is proven of values has room on a wide screen.
    """
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("action", no_wrap=True)
    risks = _risks(record)
    has_bounds = width >= _WIDE and any(
        action.at_least is not None or action.at_most is not None for action in record.actions
    )
    bounds = ["at least", "at most"] if has_bounds else []
    for column in ("value", "±", *bounds, "visits", *(["risk"] if risks else [])):
        table.add_column(column, justify="right", no_wrap=True)
    best = by_worth(record.actions, record.simulations)
    shown = best if len(best) <= rows else best[: max(rows - 1, 1)]
    names = _fitting([value.action for value in shown], width - 30 - (_BOUNDS_CELLS if has_bounds else 0))
    digits = Digits.of((value.q for value in shown), 2)
    for value, name in zip(shown, names, strict=True):
        style = "bold" if value.action == record.action else ""
        proven = proven_texts(value, digits) if has_bounds else ()
        numbers = (digits.signed(value.q), digits.plain(value.stderr), *proven, f"{value.n:,}")
        risk = [risks[value.action]] if risks else []
        table.add_row(Text(name, style), *numbers, *risk, style=style)
    if len(shown) < len(best):
        table.add_row(Text(f"and {len(best) - len(shown)} more", style="dim"))
    return table


def _risks(record: DecisionRecord) -> dict[str, str]:
    """Returns for each action the most that it risks of any constraint, and whether that is too much."""
    if not record.constraints:
        return {}
    texts = {}
    for number, value in enumerate(record.actions):
        is_barred = any(constraint.risks[number] > constraint.left for constraint in record.constraints)
        most = max(constraint.risks[number] for constraint in record.constraints)
        texts[value.action] = f"{most:.3g}{' too much' if is_barred else ''}"
    return texts


def belief_bars(belief: BeliefSummary, rows: int) -> Table:
    """A bar for each likely value of each state variable; of a number with many values its median."""
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim")
    for column in ("belief", "", "", ""):
        table.add_column(column, no_wrap=True)
    for marginal in belief.marginals:
        if marginal.quantiles:
            if table.row_count < rows:
                table.add_row(marginal.variable, *_number_cells(marginal.quantiles))
            continue
        for index, (value, probability) in enumerate(list(marginal.values.items())[:_SHOWN_VALUES]):
            name = marginal.variable if index == 0 else ""
            if table.row_count < rows:
                table.add_row(name, value, _bar(probability), chance_text(probability))
    return table


def _number_cells(quantiles: tuple[float, ...]) -> tuple[str, str, str]:
    low, _, median, _, high = quantiles
    return f"{median:.3g}", f"{low:.3g} to {high:.3g}", "90 %"


def progress_text(progress: SkillProgress) -> Text:
    """Shows how far a skill is, as a bar and a number, and what it does."""
    text = _bar(progress.progress, _PROGRESS_CELLS).append(f" {progress.progress:.0%}")
    said = ": ".join(word for word in (progress.state, progress.text) if word and word != "executing")
    return text.append(f" {said}" if said else "")


def belief_lines(belief: BeliefSummary, width: int, rows: int) -> list[Text]:
    """The same as text for a narrow screen, `holding_can true 0.75 false 0.25`; doubtful variables first."""
    doubtful = sorted(belief.marginals, key=lambda marginal: max(marginal.values.values(), default=1.0))
    lines: list[Text] = []
    for marginal in doubtful:
        item = Text.assemble((f"{marginal.variable} ", "dim"), _values_text(marginal))
        item.truncate(width, overflow="ellipsis")
        if lines and lines[-1].cell_len + 3 + item.cell_len <= width:
            lines[-1].append("   ").append(item)
        elif len(lines) == rows:
            lines[-1].truncate(width - 4)
            lines[-1].append(" ...", style="dim")
            break
        else:
            lines.append(item)
    return lines


def _values_text(marginal: Marginal) -> str:
    if marginal.quantiles:
        return "{} (90 %: {})".format(*_number_cells(marginal.quantiles))
    return " ".join(
        value if probability > 0.9995 else f"{value} {probability:.2f}"
        for value, probability in list(marginal.values.items())[:_SHOWN_VALUES]
    )


def _fitting(actions: list[str], width: int) -> list[str]:
    """The actions as they are, or without their parameters' names, or with their middle left out."""
    if max(map(len, actions), default=0) > width:
        actions = [brief_action(action) for action in actions]
    width = max(width, 8)
    heads = sorted(range(width), key=lambda head: abs(head - width // 2))
    cuts = ([_without_middle(action, width, head) for action in actions] for head in heads)
    return max(cuts, key=lambda names: len(set(names)))  # The first one in which the most can be told apart.


def _without_middle(text: str, width: int, head: int) -> str:
    return text if len(text) <= width else f"{text[:head]}…{text[len(text) - (width - head - 1) :]}"


def _observation(record: DecisionRecord) -> Text:
    outcome = record.outcome
    if outcome is None:
        return Text("...", style="dim")
    if outcome.status != "observed":
        return Text(outcome.status, style="red")
    stopped = " (stopped)" if outcome.stopped_by else ""
    stopped += "".join(f", {monitor}: {response}" for monitor, response in outcome.monitors.items())
    return Text(
        f"{observation_text(outcome.response, outcome.numbers)}{stopped}",
        style="red" if record.is_impossible else "",
    )


def _bar(share: float, cells: int = _BAR_CELLS) -> Text:
    filled = round(share * cells)
    return Text.assemble(("█" * filled, "cyan"), ("·" * (cells - filled), "dim"))
