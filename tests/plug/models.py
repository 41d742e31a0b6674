"""Worlds of the exam as documents, without and with a variable more, and their exact beliefs.

`at` is the number of the world's state, and `v0`, `v1` and so on are the values of its variables. The
variable more, `weather`, starts by the world's state, changes by itself, and now and then spoils what is
observed.
"""

import random
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

from exam.families import FAMILIES
from exam.generation import named_problem
from exam.problem import NOTHING_SEEN, RUNNING, Problem, TooLarge
from mappings import mapping_text

Belief = Mapping[tuple[int, int], float]
"""The probability of each state with each weather."""

MAX_STATES = 40
MAX_ACTIONS = 8
DEFAULT = "DefaultObservation"


def small_problems(count: int, seed: int) -> Iterator[Problem]:
    found = 0
    while found < count:
        name = f"{list(FAMILIES)[seed % len(FAMILIES)]}/{seed}"
        seed += 1
        with suppress(TooLarge):
            problem = named_problem(name, MAX_STATES)
            if len(problem.world.actions) <= MAX_ACTIONS:
                found += 1
                yield problem


class Weather:
    """The variable that the newer documents have: values 0, 1 and 2."""

    def __init__(self, source: random.Random):
        self.start = [_odds(source) for _ in range(2)]
        self.change = [_odds(source) for _ in range(3)]
        self.spoils = [0.0, round(source.uniform(0.1, 0.9), 2), round(source.uniform(0.1, 0.9), 2)]

    def start_at(self, state: int) -> Sequence[float]:
        """The distribution in the initial belief."""
        return self.start[state % 2]


def _odds(source: random.Random) -> list[float]:
    weights = [source.randint(1, 9) for _ in range(3)]
    return [weight / sum(weights) for weight in weights]


def responses_of(problem: Problem) -> list[int]:
    seen = {response for sensing in problem.sensings for response, _ in sensing}
    return sorted(seen - {NOTHING_SEEN}) or [0]


# --- documents ---


def documents(
    problem: Problem, weather: Weather | None, without: frozenset[int] = frozenset()
) -> dict[str, str]:
    files = {"world.ef": _environment(problem, weather)}
    names = [f"r{response}" for response in responses_of(problem)]
    for action in range(len(problem.world.actions)):
        if action not in without:
            files[f"a{action}.sd"] = _skill(problem, action, weather)
            files[f"a{action}.am"] = mapping_text(*names, project="world", skill=f"a{action}")
    return files


def _environment(problem: Problem, weather: Weather | None) -> str:
    width = len(problem.world.variables)
    columns = zip(*(state for state, _ in problem.states), strict=True)
    tables = [f"const int v{i}_of[] = {_listed(column)};" for i, column in enumerate(columns)]
    tables.append(f"const int ending_of[] = {_listed(ending for _, ending in problem.states)};")
    start = [
        f"vector<int> starts{_listed(state for state, _ in problem.starts)};",
        f"state.at = AOS.SampleDiscrete(starts, {_listed(odds for _, odds in problem.starts)});",
        *(f"state.v{i} = v{i}_of[state.at];" for i in range(width)),
        "state.ended = 0;",
    ]
    if weather is not None:
        start.append("vector<int> kinds{0, 1, 2};")
        start.append(
            f"if (state.at % 2 == 0) state.weather = AOS.SampleDiscrete(kinds, {_listed(weather.start[0])});"
        )
        start.append(f"else state.weather = AOS.SampleDiscrete(kinds, {_listed(weather.start[1])});")
    change = (
        []
        if weather is None
        else [
            "extrinsic_code:",
            "vector<int> kinds{0, 1, 2};",
            *(
                f"if (state.weather == {kind}) state_.weather = AOS.SampleDiscrete(kinds, {_listed(odds)});"
                for kind, odds in enumerate(weather.change)
            ),
            "",
        ]
    )
    lines = [
        "project: world",
        f"horizon: {problem.world.horizon}",
        "discount: 0.95",
        "",
        "shared_code:",
        *tables,
        "",
        *(f"state_variable: int {name}" for name in ("at", *(f"v{i}" for i in range(width)), "ended")),
        *(["state_variable: int weather"] if weather is not None else []),
        "",
        "initial_belief:",
        *start,
        "",
        *change,
        "reward_code:",
        "if (state.ended == 1) { __reward = 1; __isGoalState = true; }",
        "",
        "reward_code:",
        "if (state.ended == 2) { __reward = -1; __isGoalState = true; }",
        "",
    ]
    return "\n".join(lines)


def _skill(problem: Problem, action: int, weather: Weather | None) -> str:
    lines = ["project: world", "dynamic_model:", "int next = state.at;", "int sensing = -1;"]
    lines.append("switch (state.at) {")
    for state, (_, ending) in enumerate(problem.states):
        if ending != RUNNING:
            continue
        row = problem.rows[state, action]
        lines.append(f"case {state}: {{")
        lines.append(f"    vector<int> outcomes{_listed(range(len(row)))};")
        lines.append(f"    int outcome = AOS.SampleDiscrete(outcomes, {_listed(odds for odds, *_ in row)});")
        lines.append(f"    const int nexts[] = {_listed(after for _, after, _, _ in row)};")
        lines.append(f"    const int sensings[] = {_listed(sensing for _, _, sensing, _ in row)};")
        lines.append("    next = nexts[outcome]; sensing = sensings[outcome]; break;")
        lines.append("}")
    lines += ["}", "int seen = -1;", "switch (sensing) {"]
    for number, sensing in enumerate(problem.sensings):
        lines.append(f"case {number}: {{")
        lines.append(f"    vector<int> responses{_listed(response for response, _ in sensing)};")
        lines.append(f"    seen = AOS.SampleDiscrete(responses, {_listed(odds for _, odds in sensing)});")
        lines.append("    break;\n}")
    lines.append("}")
    responses = responses_of(problem)
    if weather is not None:
        lines.append("if (sensing >= 0 && state_.weather > 0) {")
        lines.append(f"    vector<int> any{_listed(responses)};")
        spoils = f"state_.weather == 1 ? {weather.spoils[1]!r} : {weather.spoils[2]!r}"
        lines.append(f"    if (AOS.Bernoulli({spoils})) {{")
        lines.append(
            f"        seen = AOS.SampleDiscrete(any, {_listed([1 / len(responses)] * len(responses))});"
        )
        lines.append("    }\n}")
    lines.append("state__.at = next;")
    lines += [f"state__.v{i} = v{i}_of[next];" for i in range(len(problem.world.variables))]
    lines.append("state__.ended = ending_of[next];")
    lines += [f"if (seen == {response}) __moduleResponse = r{response};" for response in responses]
    return "\n".join([*lines, ""])


def _listed(values: Iterable[object]) -> str:
    return "{" + ", ".join(repr(value) for value in values) + "}"


# --- the truth ---


def initial(problem: Problem, weather: Weather) -> Belief:
    return {
        (state, kind): odds * share
        for state, odds in problem.starts
        for kind, share in enumerate(weather.start_at(state))
    }


def stepped(
    problem: Problem, weather: Weather, belief: Belief, action: int | None
) -> dict[str, dict[tuple[int, int], float]]:
    """The weights of states by what is observed after an action; without one the weather alone changes."""
    after: dict[str, dict[tuple[int, int], float]] = defaultdict(lambda: defaultdict(float))
    for (state, kind), share in belief.items():
        if problem.states[state][1] != RUNNING:
            after[DEFAULT][state, kind] += share
            continue
        for new, odds in enumerate(weather.change[kind]):
            if action is None:
                after[DEFAULT][state, new] += share * odds
                continue
            for part, following, sensing, _ in problem.rows[state, action]:
                for response, likelihood in _seen(problem, weather, sensing, new):
                    after[response][following, new] += share * odds * part * likelihood
    return after


def _seen(problem: Problem, weather: Weather, sensing: int, kind: int) -> Iterator[tuple[str, float]]:
    spoilt = weather.spoils[kind]
    for response, odds in problem.sensings[sensing]:
        yield (DEFAULT if response == NOTHING_SEEN else f"r{response}"), odds * (1 - spoilt)
    if spoilt:
        responses = responses_of(problem)
        for response in responses:
            yield f"r{response}", spoilt / len(responses)
