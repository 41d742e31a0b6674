"""Tables for people: the value of each action, and simulated missions."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from rich.bar import Bar
from rich.table import Table
from rich.text import Text

from aos_deploy.printing import count
from aos_deploy.terminal import console, print_table
from aos_deploy.views.lines import observation_text
from aos_deploy.views.values import Digits, by_worth, proven_texts
from aos_protocol.messages import ActionValue
from aos_solver.mission.rules.endings import Ending
from aos_solver.mission.simulation import SimulatedRun

_DECIMALS = 3
BAR_WIDTH = 30
LONGEST_ACTION = 48
"""The limit in letters; a longer action takes several lines."""
NUMBERS_WIDTH = 38
"""The width of all but the action, the bounds and the bar, with the lines between."""
BOUNDS_WIDTH = 24
VALUE_WIDTH = 22
"""The width of the value, of a bar of one letter, and of the lines between."""

BEST = 12
"""So many actions are shown where not all are asked for; one more takes the place of the line about it."""

STORY_WIDTH = 120
NARROW = 80
"""The width below which the missions' actions stand below the table."""
FIRST_STEPS, LAST_STEPS = 8, 6
"""A mission with more steps is told without those between; `--json` has them."""

_LESS_THAN_THE_PLAN = (
    "Some plan returns `at least` so much. A mission plans anew at each step, with a whole horizon to go: "
    "it may put off what that plan does at its end, and return less."
)


def print_values(values: list[ActionValue], simulations: int, title: str, *, shows_all: bool = True) -> None:
    """The actions, best first, with a bar from the worst value to the best; `title` is for no simulations.

    Errors and visits stand beside values where there is room, and what is proven of them, rounded outwards.
    Where not all are shown, a line tells how many more there are, and what they are worth at most.
    """
    ranked = by_worth(values, simulations)
    values = ranked if shows_all or len(ranked) <= BEST + 1 else ranked[:BEST]
    known = [value for value in values if value.is_known(simulations)]
    lowest = min((value.q for value in known), default=0.0)
    highest = max((value.q for value in known), default=0.0)
    digits = Digits.of((value.q for value in values), _DECIMALS)
    wider = max(digits.decimals - _DECIMALS, 0)
    table = Table(title=f"{simulations:,} simulations" if simulations else title)
    out = console(is_wide=True)
    # Bars give way first: actions often differ in their last letters only.
    longest = min(max(len(value.action) for value in values), LONGEST_ACTION)
    numbers_width = NUMBERS_WIDTH + 2 * wider
    bounds_width = BOUNDS_WIDTH + 2 * wider
    has_errors = bool(simulations) and longest + numbers_width <= out.width
    action_width = longest if has_errors else max(min(longest, out.width - VALUE_WIDTH - wider), 1)
    has_room = action_width + numbers_width + bounds_width <= out.width
    has_bounds = has_room and any(value.at_least is not None or value.at_most is not None for value in values)
    numbers_width += bounds_width if has_bounds else 0
    bar_width = max(min(BAR_WIDTH, out.width - action_width - numbers_width), 1)
    table.add_column("action", overflow="fold", min_width=action_width)
    table.add_column("value", justify="right")
    if has_errors:
        table.add_column("stderr", justify="right")
        table.add_column("visits", justify="right")
    if has_bounds:
        table.add_column("at least", justify="right")
        table.add_column("at most", justify="right")
    table.add_column("")
    for value in values:
        row = [value.action, digits.signed(value.q)]
        if has_errors:
            row += [digits.plain(value.stderr), f"{value.n:,}"]
        if has_bounds:
            row += proven_texts(value, digits)
        size = (highest - lowest) or 1.0
        table.add_row(*row, Bar(size, 0, max(value.q - lowest, 0), width=bar_width, color="cyan"))
    out.print(table)
    if more := ranked[len(values) :]:
        worth = f", worth {digits.signed(more[0].q)} at most" if more[0].is_known(simulations) else ""
        out.print(f"{count(len(more), 'more action')}{worth}; `--all` and `--json` have them")
    if any(value.at_least is not None and value.q + 2 * value.stderr < value.at_least for value in known):
        out.print(_LESS_THAN_THE_PLAN, style="dim")


def print_states(run: SimulatedRun) -> None:
    """A mission step by step: what was done and seen, and what the world was then."""
    table = Table(title=f"seed {run.seed}", title_justify="left")
    table.add_column("step", justify="right")
    for name in ("action", "observation", "state"):
        table.add_column(name)
    rows = zip(("", *run.actions), ("", *_observations(run)), run.states, strict=True)
    for number, (action, observation, state) in enumerate(rows):
        table.add_row(str(number), Text(action), Text(observation), Text(state.rstrip()))
    console(is_wide=True).print(table)


def print_runs(runs: Iterable[SimulatedRun], summary: dict[str, float], *, has_goals: bool = True) -> None:
    """The states of the missions that have them; one row for each mission, and the summary.

    A row tells how the world has ended, and how the mission, which knows its belief alone. Only documents
    have goals and failures.
    """
    runs = tuple(runs)
    for run in runs:
        if run.states:
            print_states(run)
    out = console(is_wide=True)
    stories = {run.seed: ", ".join(_story(run)) for run in runs}
    if out.width >= NARROW:
        out.print(_runs_table(runs, stories))
    else:
        print_table(_runs_table(runs))
        for seed, story in stories.items():
            out.print(f"{seed}: {story}")
    mean, stderr = summary["mean_discounted_return"], summary.get("stderr")
    digits = Digits.of((mean, stderr or 0.0), 2)
    error = "" if stderr is None else f" ± {digits.plain(stderr)}"
    missions = count(len(runs), "mission")
    endings = (
        f"goal in {summary['goal_rate']:.0%} of {missions}, "
        f"believed in {summary['believed_goal_rate']:.0%}{_unnoticed(runs)}, "
        f"failure in {summary['failure_rate']:.0%}{_other_endings(runs)}"
        if has_goals
        else missions
    )
    returned = f"discounted return {digits.signed(mean)}{error}"
    out.print(f"{endings}, {returned}, {summary['mean_steps']:.1f} steps")


def _unnoticed(runs: Collection[SimulatedRun]) -> str:
    """` (100% ended with the world, unnoticed)`: there a robot, which believes in no end, would go on."""
    number = sum(run.ending is run.world_ending and run.believed_ending is None for run in runs)
    return f" ({number / len(runs):.0%} ended with the world, unnoticed)" if number else ""


def _other_endings(runs: Collection[SimulatedRun]) -> str:
    """`, step_limit in 35%`: how the missions ended of which the belief says neither goal nor failure."""
    told = Counter(run.ending.value for run in runs)
    for ending in (Ending.GOAL, Ending.FAILURE):
        told.pop(ending.value, None)
    return "".join(f", {name} in {number / len(runs):.0%}" for name, number in told.most_common())


def _runs_table(runs: Collection[SimulatedRun], stories: Mapping[int, str] | None = None) -> Table:
    """A row for each mission, with what it did by its seed where that stands in the table."""
    table = Table()
    for name in ("seed", "world", "mission", "steps", "return"):
        is_text = name in ("world", "mission")
        table.add_column(name, justify="left" if is_text else "right", overflow="fold")
    if stories is not None:
        table.add_column("actions and observations", max_width=STORY_WIDTH, overflow="fold")
    digits = Digits.of((run.total for run in runs), 1)
    for run in runs:
        world = run.world_ending.value if run.world_ending is not None else "goes on"
        story = () if stories is None else (stories[run.seed],)
        numbers = (str(run.steps), digits.signed(run.total))
        table.add_row(str(run.seed), world, run.ending.value, *numbers, *story)
    return table


def _story(run: SimulatedRun) -> list[str]:
    steps = [
        f"{action} → {observation}"
        for action, observation in zip(run.actions, _observations(run), strict=True)
    ]
    between = len(steps) - FIRST_STEPS - LAST_STEPS
    if between > 1:
        steps[FIRST_STEPS:-LAST_STEPS] = [f"… {count(between, 'more step')} …"]
    return steps


def _observations(run: SimulatedRun) -> list[str]:
    numbers = run.numbers or ({},) * len(run.observations)
    monitors = run.monitors or ({},) * len(run.observations)
    return [
        observation_text(response, beside) + "".join(f", {name}: {said}" for name, said in told.items())
        for response, beside, told in zip(run.observations, numbers, monitors, strict=True)
    ]
