"""The flattening of a POMDP over variables to one over states: those that can be reached, and no others."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import msgspec
import numpy as np

from aos_lab.formats.factors import Factor, Table, Variable
from aos_protocol.errors import DocumentError, IntractableError
from aos_solver.offline.explicit_model import ExplicitModel, Floats, Integers, Ragged, StartBelief

MAX_STATES = 2_000_000

_SUM_TOLERANCE = 1e-4
"""Files are written with few digits; sums that are off by less are set right."""

Progress = Callable[[int], None]


class StateVariable(msgspec.Struct, frozen=True):
    """A variable before and after a step; the robot sees a `is_seen` one."""

    before: Variable
    after: Variable
    is_seen: bool


class FactoredModel(msgspec.Struct, frozen=True, kw_only=True):
    """The variables and tables of a `.pomdpx` file.

    There is a table of `initial` and one of `transitions` for every state variable, and one of `sensing` for
    every observation variable; `rewards` are added up.
    """

    name: str
    discount: float
    states: tuple[StateVariable, ...]
    actions: tuple[Variable, ...]
    observations: tuple[Variable, ...]
    initial: tuple[Table, ...]
    transitions: tuple[Table, ...]
    sensing: tuple[Table, ...]
    rewards: tuple[Table, ...]


class _Frame:
    """Assignments of values to variables, a row each, with the row of the beginning it comes from."""

    def __init__(self, columns: dict[str, Integers], rows: int) -> None:
        self.columns = columns
        self.origin = np.arange(rows)
        self.probability = np.ones(rows)

    def draw(self, table: Table, factor: Factor, name: str, action: Mapping[str, str] | None = None) -> None:
        """Follows every outcome of a distribution; the model's `name` and the `action` are for errors."""
        row_count = len(self.origin)
        rows, values, chances = factor.outcomes(self.columns, row_count)
        totals = np.bincount(rows, chances, minlength=row_count)
        if (wrong := np.abs(totals - 1) > _SUM_TOLERANCE).any():
            row = int(np.argmax(wrong))
            raise DocumentError(
                f"{name}:{table.place}: the probabilities of {table.own} sum to {totals[row]:g}"
                f"{self._given(table, factor, row, action or {})}",
                code="AOS122",
                hint="They have to sum to 1",
            )
        self.columns = {key: column[rows] for key, column in self.columns.items()}
        self.columns[table.own] = values
        self.origin = self.origin[rows]
        self.probability = self.probability[rows] * chances / totals[rows]

    def _given(self, table: Table, factor: Factor, row: int, action: Mapping[str, str]) -> str:
        variables = {variable.name: variable for variable in table.variables}
        parents = [f"{name}={value}" for name, value in action.items() if name in variables]
        parents += [f"{axis}={variables[axis].values[self.columns[axis][row]]}" for axis in factor.axes[:-1]]
        return f" for {', '.join(parents)}" if parents else ""

    def look_up(self, factor: Factor) -> Floats:
        """The value of a table in every row."""
        return factor.values(self.columns, len(self.origin))


class _Code:
    """Values of several variables as one number, and back."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        self.variables = variables
        self._sizes = [len(variable.values) for variable in variables]
        if np.prod(self._sizes, dtype=float) > 2**62:
            raise IntractableError("the variables have more than 2^62 combinations")

    def encode(self, columns: Mapping[str, Integers], rows: int) -> Integers:
        code = np.zeros(rows, dtype=np.int64)
        for variable, size in zip(self.variables, self._sizes, strict=True):
            code = code * size + columns[variable.name]
        return code

    def decode(self, code: Integers) -> dict[str, Integers]:
        columns: dict[str, Integers] = {}
        for variable, size in zip(reversed(self.variables), reversed(self._sizes), strict=True):
            columns[variable.name] = code % size
            code = code // size
        return columns

    def names(self, code: Integers) -> tuple[str, ...]:
        columns = self.decode(code)
        parts = [[v.values[value] for value in columns[v.name]] for v in self.variables]
        return tuple(",".join(values) for values in zip(*parts, strict=True))


def flatten(model: FactoredModel, *, max_states: int, on_progress: Progress) -> ExplicitModel:
    """The model over the states that can be reached; `on_progress` is told how many are known.

    DocumentError AOS122 for probabilities that do not sum to 1 where it matters, IntractableError where
    there are more than `max_states`.
    """
    try:
        return _Flattening(model, max_states, on_progress).result()
    except MemoryError:
        raise IntractableError(f"a table of {model.name} is too large once it is written out") from None


class _Steps(msgspec.Struct, frozen=True):
    """The effects of an action in states: outcomes by state code, and the key of what is observed."""

    before: Integers
    after: Integers
    probability: Floats
    sensing: Integers


class _Action:
    """The tables with one action chosen, ready to be looked up."""

    def __init__(self, model: FactoredModel, chosen: Mapping[str, int]) -> None:
        self.values = {variable.name: variable.values[chosen[variable.name]] for variable in model.actions}
        seen_names = {state.after.name for state in model.states if state.is_seen}
        by_name = {v.name: v for s in model.states for v in (s.before, s.after)}
        self.transitions = [(table, table.given(chosen)) for table in _ordered(model.transitions)]
        self.sensing = [(table, table.given(chosen)) for table in _ordered(model.sensing)]
        self.rewards = [table.given(chosen) for table in model.rewards]
        used = seen_names.union(*(factor.axes for _, factor in self.sensing)) & by_name.keys()
        self.sensing_code = _Code([variable for name, variable in by_name.items() if name in used])


class _Flattening:
    def __init__(self, model: FactoredModel, max_states: int, on_progress: Progress) -> None:
        self._model = model
        self._max_states = max_states
        self._on_progress = on_progress
        self._before = _Code([state.before for state in model.states])
        self._after = _Code([state.after for state in model.states])
        self._choice = _Code(model.actions)
        self._observed_states = [state for state in model.states if state.is_seen]
        self._sight = _Code([*(state.after for state in self._observed_states), *model.observations])
        count = int(np.prod([len(variable.values) for variable in model.actions]))
        choices = [self._choice.decode(np.array([number])) for number in range(count)]
        self._actions = [_Action(model, {k: int(v[0]) for k, v in choice.items()}) for choice in choices]

    def result(self) -> ExplicitModel:
        start = self._start()
        start_codes = self._before.encode(start.columns, len(start.origin))
        steps, codes = self._explore(np.unique(start_codes))
        likelihoods, first_sensing, sight_codes = self._likelihoods(steps)
        rows, order, joined = _sorted_steps(steps, codes)
        sensings = np.concatenate(
            [
                first + np.searchsorted(_keys(found), _all(found, "sensing"))
                for first, found in zip(first_sensing, steps, strict=True)
            ]
        )
        return ExplicitModel(
            name=self._model.name,
            discount=self._model.discount,
            states=self._before.names(codes),
            actions=self._choice.names(np.arange(len(self._actions))),
            observations=self._sight.names(sight_codes),
            rewards=self._rewards(codes),
            outcomes=Ragged(
                np.searchsorted(rows[order], np.arange(len(codes) * len(steps) + 1)),
                np.searchsorted(codes, joined.after[order]),
                joined.probability[order],
            ),
            sensings=sensings[order],
            likelihoods=likelihoods,
            starts=self._starts(start, np.searchsorted(codes, start_codes)),
        )

    def _start(self) -> _Frame:
        frame = _Frame({}, 1)
        for table in _ordered(self._model.initial):
            frame.draw(table, table.given({}), self._model.name)
        return frame

    def _starts(self, start: _Frame, states: Integers) -> tuple[StartBelief, ...]:
        codes = _Code([state.before for state in self._observed_states]).encode(start.columns, len(states))
        beliefs = []
        for group in np.unique(codes):
            chosen = codes == group
            weight = float(start.probability[chosen].sum())
            beliefs.append(StartBelief(weight, states[chosen], start.probability[chosen] / weight))
        return tuple(beliefs)

    def _explore(self, frontier: Integers) -> tuple[list[list[_Steps]], Integers]:
        steps: list[list[_Steps]] = [[] for _ in self._actions]
        known = frontier
        while len(frontier):
            reached = []
            for action, found in zip(self._actions, steps, strict=True):
                found.append(self._steps_of(action, frontier))
                reached.append(np.unique(found[-1].after))
            frontier = np.setdiff1d(np.concatenate(reached), known, assume_unique=False)
            known = np.union1d(known, frontier)
            self._on_progress(len(known))
            if len(known) > self._max_states:
                raise IntractableError(
                    f"{self._model.name} has more than {self._max_states} states that can be reached"
                )
        return steps, known

    def _frame_after(self, action: _Action, codes: Integers) -> _Frame:
        frame = _Frame(self._before.decode(codes), len(codes))
        for table, factor in action.transitions:
            frame.draw(table, factor, self._model.name, action.values)
        return frame

    def _steps_of(self, action: _Action, codes: Integers) -> _Steps:
        frame = self._frame_after(action, codes)
        rows = len(frame.origin)
        return _Steps(
            codes[frame.origin],
            self._after.encode(frame.columns, rows),
            frame.probability,
            action.sensing_code.encode(frame.columns, rows),
        )

    def _likelihoods(self, steps: list[list[_Steps]]) -> tuple[Ragged, list[int], Integers]:
        """The observations of every (action, key), the first row of every action, and the sights' codes."""
        firsts, rows, sights, chances, count = [], [], [], [], 0
        for action, found in zip(self._actions, steps, strict=True):
            keys = _keys(found)
            frame = _Frame(action.sensing_code.decode(keys), len(keys))
            for table, factor in action.sensing:
                frame.draw(table, factor, self._model.name, action.values)
            firsts.append(count)
            rows.append(count + frame.origin)
            sights.append(self._sight.encode(frame.columns, len(frame.origin)))
            chances.append(frame.probability)
            count += len(keys)
        codes, numbers = np.unique(np.concatenate(sights), return_inverse=True)
        first = np.searchsorted(np.concatenate(rows), np.arange(count + 1))
        return Ragged(first, numbers, np.concatenate(chances)), firsts, codes

    def _rewards(self, codes: Integers) -> Floats:
        rewards = np.zeros((len(codes), len(self._actions)))
        before = _Frame(self._before.decode(codes), len(codes))
        for number, action in enumerate(self._actions):
            after: _Frame | None = None
            for factor in action.rewards:
                if set(factor.axes) <= before.columns.keys():
                    rewards[:, number] += before.look_up(factor)
                    continue
                after = after or self._frame_with_sights(action, codes)
                given = after.probability * after.look_up(factor)
                rewards[:, number] += np.bincount(after.origin, given, minlength=len(codes))
        return rewards

    def _frame_with_sights(self, action: _Action, codes: Integers) -> _Frame:
        frame = self._frame_after(action, codes)
        for table, factor in action.sensing:
            frame.draw(table, factor, self._model.name, action.values)
        return frame


def _ordered(tables: Iterable[Table]) -> list[Table]:
    """Tables so that each follows those of its parents; in a circle the order stays as it is."""
    waiting, done = list(tables), []
    while waiting:
        own = {table.own for table in waiting}
        ready = [t for t in waiting if not own & {variable.name for variable in t.variables[:-1]}]
        done += ready or waiting
        waiting = [table for table in waiting if table not in done]
    return done


def _all(found: list[_Steps], field: str) -> Integers:
    return np.concatenate([getattr(steps, field) for steps in found])


def _keys(found: list[_Steps]) -> Integers:
    return np.unique(_all(found, "sensing"))


def _sorted_steps(steps: list[list[_Steps]], codes: Integers) -> tuple[Integers, Integers, _Steps]:
    """The row of every outcome, the order by row and next state, and all outcomes, action by action."""
    joined = _Steps(*(np.concatenate([_all(found, f) for found in steps]) for f in _Steps.__struct_fields__))
    action = np.repeat(np.arange(len(steps)), [sum(len(s.after) for s in found) for found in steps])
    rows = np.searchsorted(codes, joined.before) * len(steps) + action
    return rows, np.lexsort((joined.after, rows)), joined
