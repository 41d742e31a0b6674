"""The live view of a mission in a terminal."""

import io
import threading
import time
from collections.abc import Iterator
from typing import Self

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.live import Live
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from aos_deploy.events import Event, ServiceChanged, Told
from aos_deploy.terminal import console as our_console
from aos_deploy.views.lines import effort_text, endings_text, lines_of, risk_text
from aos_deploy.views.panels import belief_bars, belief_lines, progress_text, step_table, value_table
from aos_protocol.chances import chance_text
from aos_protocol.messages import BundleReport, DecisionRecord, MissionState, SkillProgress

_FIXED_ROWS = 11
"""Everything but the rows of steps, values and belief."""
_FEWEST_ROWS = 3
_GAP_CELLS = 4
_SPINNER_CELLS = 2
_SERVICE_STYLES = {"starting": "yellow", "ready": "green", "stopping": "yellow", "ended": "dim"}


class Screen:
    """The contents of the screen, as far as the events have told.

    It keeps to the height of the terminal from 24 rows on, and needs 80 columns. It may be drawn by another
    thread than the one that tells it events.
    """

    def __init__(self, title: str) -> None:
        self.title = title
        self.is_over = False
        self.services: dict[str, str] = {}
        self.remark, self.printed = "starting", ""
        self.remark_since_s = time.monotonic()
        self.state: MissionState | None = None
        self.steps: dict[int, DecisionRecord] = {}
        self.latest: DecisionRecord | None = None
        self.progress: SkillProgress | None = None
        self._one_at_a_time = threading.Lock()

    def take(self, event: Event) -> None:
        """Brings the screen up to date."""
        with self._one_at_a_time:
            self._take(event)

    def _take(self, event: Event) -> None:
        match event:
            case ServiceChanged():
                # A process that ended by itself is printed above the screen, too.
                self.services[event.service] = event.state
                waiting = [name for name, state in self.services.items() if state == "starting"]
                if event.state == "stopping":
                    self._remark(": ".join(filter(None, (f"stopping {event.service}", event.detail))))
                elif waiting and self.state is None:
                    self._remark(f"waiting for {', '.join(waiting)}")
            case Told():
                self._remark(event.text)
            case MissionState():
                if self.state is not None and event.mission != self.state.mission:
                    self.steps, self.latest = {}, None  # Another mission of a system that stays.
                self.state = event
                self._remark(event.remark or event.phase)
            case DecisionRecord():
                self.latest = self.steps[event.step] = event
            case SkillProgress():
                self.progress = event
            case BundleReport():
                # It is printed above the screen, which goes on to tell what the robot does.
                pass

    def _remark(self, text: str) -> None:
        # How far work is changes often, and says nothing about since when the work goes on.
        if text.partition(":")[0] != self.remark.partition(":")[0]:
            self.remark_since_s = time.monotonic()
        self.remark = text

    def __rich_console__(self, console: Console, _: ConsoleOptions) -> RenderResult:
        with self._one_at_a_time:
            return list(self._parts(console))

    def _parts(self, console: Console) -> Iterator[RenderableType]:
        yield self._headline()
        yield self._services()
        if self.latest is not None:
            yield Text()
            yield from self._mission(self.latest, console.width, console.height - _FIXED_ROWS)
        yield Text()
        yield from self._progress(console.width)

    def _mission(self, latest: DecisionRecord, width: int, rows: int) -> Iterator[RenderableType]:
        """Steps, values and belief within a number of rows; the latter two side by side where that fits."""
        rows -= any(record.remark for record in self.steps.values()) + len(latest.constraints)
        rows = max(rows, 3 * _FEWEST_ROWS)
        bars = belief_bars(latest.belief, rows // 2)
        is_wide = _cells(bars) + _GAP_CELLS + _cells(value_table(latest, width, rows)) <= width
        below = [] if is_wide else belief_lines(latest.belief, width, max(rows // 4, 2))
        free = rows - len(below)
        details = max(len(latest.actions), bars.row_count if is_wide else 0)
        details = min(details, max(free - len(self.steps), free // 2))
        shown = sorted(self.steps)[-(free - details) :]
        yield step_table([self.steps[step] for step in shown], width)
        yield from self._step_remark(shown)
        yield Text()
        values = value_table(latest, width, details)
        if is_wide:
            columns = Table.grid(padding=(0, _GAP_CELLS))
            columns.add_row(belief_bars(latest.belief, details), values)
            yield columns
        else:
            yield values
            yield Text()
            yield from below
        yield Text(effort_text(latest), style="dim")
        for constraint in latest.constraints:
            yield Text(risk_text(constraint), style="dim", no_wrap=True, overflow="ellipsis")

    def _headline(self) -> Text:
        text = Text(self.title, style="bold", no_wrap=True, overflow="ellipsis")
        if self.state is not None:
            goal = f"goal {chance_text(self.state.goal_probability)}"
            endings = endings_text(self.latest.belief) if self.latest is not None else goal
            text.append(f"   step {self.state.step}   {self.state.phase}   {endings}", style="not bold")
        return text

    def _services(self) -> Text:
        """`ready: router, registry   starting: solver`."""
        text = Text(no_wrap=True, overflow="ellipsis")
        for state in dict.fromkeys(self.services.values()):
            text.append(f"{state}: ", style=_SERVICE_STYLES.get(state, ""))
            text.append(", ".join(name for name, its in self.services.items() if its == state) + "   ", "dim")
        return text

    def _progress(self, width: int) -> Iterator[RenderableType]:
        ending = ""
        if self.state is not None and self.state.phase == "ended":
            ending = self.state.remark
            yield Text(f"{self.state.ending}: {ending}", style="bold")
        if self.is_over:
            yield Text("" if self.remark in (ending, self.printed) else self.remark)
        elif self.remark != ending:
            elapsed_s = time.monotonic() - self.remark_since_s
            room, clock = width - _SPINNER_CELLS, f" ... {elapsed_s:.0f} s"
            text = Text(self.remark)
            text.truncate(room - len(clock), overflow="ellipsis")
            text.append(clock).append_text(self._of_the_skill()).truncate(room, overflow="ellipsis")
            yield Spinner("dots", text)

    def _of_the_skill(self) -> Text:
        """Shows how far the skill of this step is; empty before a skill says so, and when it has ended."""
        state, progress = self.state, self.progress
        if state is None or progress is None or state.phase != "acting" or not progress.goes_on:
            return Text()
        has_begun = progress.state != "accepted"
        is_of_this_step = has_begun and (progress.id.mission, progress.id.step) == (state.mission, state.step)
        return Text("  ").append_text(progress_text(progress)) if is_of_this_step else Text()

    def _step_remark(self, shown: list[int]) -> Iterator[Text]:
        """Yields the remark of the newest of the steps that has one."""
        remarked = [step for step in shown if self.steps[step].remark]
        if remarked:
            text = f"step {remarked[-1]}: {self.steps[remarked[-1]].remark}"
            yield Text(text, style="yellow", no_wrap=True, overflow="ellipsis")


class LiveView:
    """Redraws a `Screen` four times a second and at each event; leaves its last state on the terminal."""

    def __init__(self, title: str, console: Console | None = None) -> None:
        self.screen = Screen(title)
        shown = console or our_console()
        self._live = Live(self.screen, console=shown, refresh_per_second=4, transient=False)

    def __enter__(self) -> Self:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.screen.is_over = True
        self._live.stop()

    def __call__(self, event: Event) -> None:
        self.screen.take(event)
        if isinstance(event, SkillProgress):
            return  # It can come many times a second.
        is_end = isinstance(event, ServiceChanged) and event.state == "ended" and event.detail
        state = self.screen.state
        is_news = isinstance(event, Told) and (state is None or state.phase != "ended")
        if isinstance(event, BundleReport) or is_end or is_news:
            # An address of a page is one line, however long: a terminal makes it a link as a whole.
            self._live.console.print(
                "\n".join(lines_of(event)), markup=False, highlight=False, soft_wrap=is_news
            )
            if state is None and isinstance(event, Told):
                self.screen.printed = event.text
        self._live.refresh()


def _cells(table: Table) -> int:
    """The width that a table takes where nothing limits it."""
    wide = Console(width=1000, file=io.StringIO())
    return wide.measure(table).maximum
