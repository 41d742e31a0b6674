"""The live view of a mission in a terminal."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Self

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.live import Live
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from aos_deploy.events import Event, ServiceChanged, Told
from aos_deploy.views.lines import effort_text, endings_text, lines_of
from aos_deploy.views.observations import observation_text
from aos_protocol.messages import (
    ActionValue,
    BeliefSummary,
    BundleReport,
    DecisionRecord,
    MissionState,
)

__all__ = ["LiveView", "Screen"]

_BAR_CELLS = 20
_FEWEST_STEPS = 3
_OTHER_ROWS = 12
_SHOWN_VALUES = 4
_SERVICE_STYLES = {"starting": "yellow", "ready": "green", "stopping": "yellow", "ended": "dim"}


class Screen:
    """What is on the screen, as far as the events have told."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.services: dict[str, str] = {}
        self.remark = "starting"
        self.remark_since_s = time.monotonic()
        self.state: MissionState | None = None
        self.steps: dict[int, DecisionRecord] = {}
        self.latest: DecisionRecord | None = None

    def take(self, event: Event) -> None:
        """Brings the screen up to date."""
        match event:
            case ServiceChanged():
                self.services[event.service] = event.state
                waiting = [name for name, state in self.services.items() if state == "starting"]
                if waiting and self.state is None:
                    self._remark(f"waiting for {', '.join(waiting)}")
            case Told():
                self._remark(event.text)
            case MissionState():
                self.state = event
                self._remark(event.remark or event.phase)
            case DecisionRecord():
                self.latest = self.steps[event.step] = event
            case BundleReport():
                self._remark(lines_of(event)[-1])

    def _remark(self, text: str) -> None:
        if text != self.remark:
            self.remark, self.remark_since_s = text, time.monotonic()

    def __rich_console__(self, console: Console, _: ConsoleOptions) -> RenderResult:
        yield self._headline()
        yield self._services()
        if self.latest is not None:
            beliefs, values = _belief_table(self.latest.belief), _value_table(self.latest)
            columns = Table.grid(padding=(0, 4))
            columns.add_row(beliefs, values)
            room = console.height - max(beliefs.row_count, values.row_count) - _OTHER_ROWS
            yield Text()
            shown = sorted(self.steps)[-max(room, _FEWEST_STEPS) :]
            yield self._step_table(shown)
            yield from self._step_remark(shown)
            yield Text()
            yield columns
            yield Text(effort_text(self.latest), style="dim")
        yield Text()
        yield from self._progress()

    def _headline(self) -> Text:
        text = Text(self.title, style="bold")
        if self.state is not None:
            goal = f"goal {self.state.goal_probability:.3f}"
            endings = endings_text(self.latest.belief) if self.latest is not None else goal
            text.append(f"   step {self.state.step}   {self.state.phase}   {endings}", style="not bold")
        return text

    def _services(self) -> Text:
        text = Text()
        for name, state in self.services.items():
            text.append(f"{name} ", style="dim")
            text.append(f"{state}   ", style=_SERVICE_STYLES.get(state, ""))
        return text

    def _progress(self) -> Iterator[RenderableType]:
        if self.state is None or self.state.phase != "ended":
            elapsed_s = time.monotonic() - self.remark_since_s
            yield Spinner("dots", Text(f"{self.remark} ... {elapsed_s:.0f} s"))
            return
        yield Text(f"{self.state.ending}: {self.state.remark}", style="bold")
        if self.remark != self.state.remark:
            yield Text(self.remark)

    def _step_remark(self, shown: list[int]) -> Iterator[Text]:
        """What the newest of the steps that has a remark has to say."""
        remarked = [step for step in shown if self.steps[step].remark]
        if remarked:
            yield Text(f"step {remarked[-1]}: {self.steps[remarked[-1]].remark}", style="yellow")

    def _step_table(self, shown: list[int]) -> Table:
        table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
        for column in ("step", "action", "value", "observation", "surprise", "goal"):
            is_number = column in ("step", "value", "surprise", "goal")
            table.add_column(column, justify="right" if is_number else "left", no_wrap=True)
        for step in shown:
            record = self.steps[step]
            chosen = _value_of(record)
            table.add_row(
                str(step),
                record.action,
                "" if chosen is None else f"{chosen.q:+.2f}",
                _observation(record),
                "" if record.outcome is None else f"{record.surprise:.2f}",
                f"{record.belief.goal_probability:.3f}",
            )
        return table


class LiveView:
    """Redraws a `Screen` four times a second and at each event; leaves its last state on the terminal."""

    def __init__(self, title: str, console: Console | None = None) -> None:
        self.screen = Screen(title)
        self._live = Live(self.screen, console=console, refresh_per_second=4, transient=False)

    def __enter__(self) -> Self:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def __call__(self, event: Event) -> None:
        self.screen.take(event)
        if isinstance(event, BundleReport):
            self._live.console.print("\n".join(lines_of(event)), markup=False, highlight=False)
        self._live.refresh()


def _value_of(record: DecisionRecord) -> ActionValue | None:
    return next((value for value in record.actions if value.action == record.action), None)


def _observation(record: DecisionRecord) -> Text:
    outcome = record.outcome
    if outcome is None:
        return Text("...", style="dim")
    if outcome.status != "observed":
        return Text(outcome.status, style="red")
    return Text(
        observation_text(outcome.response, outcome.numbers), style="red" if record.is_impossible else ""
    )


def _belief_table(belief: BeliefSummary) -> Table:
    """A bar for each likely value of each state variable."""
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim")
    for column in ("belief", "", "", ""):
        table.add_column(column, no_wrap=True)
    for marginal in belief.marginals:
        shown = list(marginal.values.items())[:_SHOWN_VALUES]
        for index, (value, probability) in enumerate(shown):
            name = marginal.variable if index == 0 else ""
            table.add_row(name, value, _bar(probability), f"{probability:.3f}")
    return table


def _value_table(record: DecisionRecord) -> Table:
    """What the search found about every action, the best first."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("action", no_wrap=True)
    for column in ("value", "±", "visits"):
        table.add_column(column, justify="right", no_wrap=True)
    for value in sorted(record.actions, key=lambda each: -each.q):
        style = "bold" if value.action == record.action else ""
        table.add_row(
            Text(value.action, style), f"{value.q:+.2f}", f"{value.stderr:.2f}", str(value.n), style=style
        )
    return table


def _bar(probability: float) -> Text:
    filled = round(probability * _BAR_CELLS)
    return Text("█" * filled, style="cyan").append("·" * (_BAR_CELLS - filled), style="dim")
