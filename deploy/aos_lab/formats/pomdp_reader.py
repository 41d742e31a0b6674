"""Reads `.pomdp`, the text format of A. Cassandra's solvers."""

from collections.abc import Sequence

import numpy as np

from aos_lab.formats.pomdp_statements import (
    Distribution,
    PomdpTables,
    RewardRules,
    Statement,
    explicit_model,
    statements_of,
)
from aos_lab.formats.problem_text import ProblemFindings, Word, advice_on_number
from aos_protocol.errors import IntractableError
from aos_protocol.spelling import did_you_mean
from aos_solver.offline.explicit_model import ExplicitModel

_SUM_TOLERANCE = 1e-4
_MAX_NAMES = 2_000_000
_MAX_OUTCOMES = 20_000_000
"""A line such as `T: * uniform` has as many as actions times the square of the states."""

_ROWS = ("identity", "reset", "uniform")
"""Words that stand for probabilities."""

_WHOLE = Word("", 1, 0)
"""The place of what the file lacks."""


def read_pomdp(name: str, data: bytes) -> ExplicitModel:
    """The model in a file; DocumentError with all findings, at their line and column, if it has mistakes."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    text = text.replace("\r\n", "\n")
    findings = ProblemFindings(name, text)
    return findings.model_of(lambda: _Reader(name, findings).read(list(statements_of(text, findings))))


class _Reader:
    def __init__(self, name: str, findings: ProblemFindings) -> None:
        self._name = name
        self._findings = findings
        self._error = findings.error
        self._names: dict[str, tuple[str, ...]] = {}
        self._numbers: dict[str, dict[str, int]] = {}
        self._discount = 1.0
        self._sign = 1.0
        self._is_seen = False
        self._start: Distribution | None = None
        self._transitions: dict[tuple[int, int], Distribution] = {}
        self._sensing: dict[tuple[int, int], Distribution] = {}
        self._last_rule: dict[tuple[str, int, int], Word] = {}
        self._own: set[tuple[str, int, int]] = set()

    def read(self, statements: Sequence[Statement]) -> ExplicitModel | None:
        """Reads the statements into a model; None where what is needed to go on is missing."""
        keywords = {statement.keyword.text for statement in statements}
        self._is_seen = not keywords & {"observations", "O"}
        for kind in ("discount", "states", "actions", "observations"):
            if kind not in keywords and not (kind == "observations" and self._is_seen):
                self._error("AOS105", f"there is no `{kind}:`", _WHOLE)
        for statement in statements:
            if statement.keyword.text in ("discount", "values", "states", "actions", "observations"):
                self._preamble(statement)
        if self._is_seen and "states" in self._names:
            # The file of an MDP: whoever acts sees the state.
            self._names["observations"] = self._names["states"]
        if len(self._names) < 3 or not all(self._names.values()):
            return None
        self._rewards = RewardRules()
        for statement in statements:
            if statement.keyword.text == "start":
                self._read_start(statement)
        for statement in statements:
            if statement.keyword.text in ("T", "O", "R"):
                self._rule(statement)
        if self._start is None:
            self._start = self._uniform("states")
        if self._findings.has_any:
            return None
        everywhere = {(action, state) for action in self._all("actions") for state in self._all("states")}
        self._check("T", self._transitions, everywhere)
        outcomes = sum(len(row) for row in self._transitions.values())
        if outcomes > _MAX_OUTCOMES:
            raise IntractableError(f"{self._name} has {outcomes:,} outcomes of actions in states")
        if self._is_seen:
            self._sensing = {(action, state): {state: 1.0} for action, state in everywhere}
        reached = {(action, after) for (action, _), row in self._transitions.items() for after in row}
        self._check("O", self._sensing, reached)
        if self._findings.has_any:
            return None
        tables = PomdpTables(self._transitions, self._sensing, self._rewards, self._start, self._is_seen)
        return explicit_model(self._name, self._discount, self._names, tables)

    # --- preamble ---

    def _preamble(self, statement: Statement) -> None:
        kind, words = statement.keyword.text, statement.words
        if not words:
            self._error("AOS105", f"`{kind}:` says nothing", statement.keyword)
        elif kind == "discount":
            self._discount = self._number(words[0])
            if not 0 <= self._discount <= 1:
                self._error("AOS106", "the discount needs to be from 0 to 1", words[0])
        elif kind == "values":
            if words[0].text not in ("reward", "cost"):
                hint = did_you_mean(words[0].text, ("reward", "cost"))
                self._error("AOS106", f"{words[0].text} is neither reward nor cost", words[0], hint)
            self._sign = -1.0 if words[0].text == "cost" else 1.0
        else:
            self._read_names(kind, words)

    def _read_names(self, kind: str, words: Sequence[Word]) -> None:
        for word in words:
            if word.text.endswith(","):
                self._error("AOS102", f"{word.text} has a comma", word, "Names stand between blanks")
        if len(words) == 1 and (count := words[0].count) is not None:
            if not 0 < count <= _MAX_NAMES:
                self._error("AOS106", f"{count} is no number of {kind}", words[0])
                return
            self._names[kind] = tuple(f"{kind[0]}{number}" for number in range(count))
        else:
            first: dict[str, Word] = {}
            for word in words:
                if first.setdefault(word.text.rstrip(",") or word.text, word) is not word:
                    self._error("AOS103", f"{word.text} is there twice", word)
            self._names[kind] = tuple(first)
        self._numbers[kind] = {name: number for number, name in enumerate(self._names[kind])}

    def _read_start(self, statement: Statement) -> None:
        words = statement.words
        if statement.variant:
            chosen = {number for word in words for number in self._some("states", word)}
            if statement.variant == "exclude":
                chosen = set(self._all("states")) - chosen
            self._start = {number: 1 / len(chosen) for number in sorted(chosen)}
            if not chosen:
                self._error("AOS122", "no state is left to start in", statement.keyword)
        elif len(words) == 1 and words[0].text == "uniform":
            self._start = self._uniform("states")
        elif len(words) == 1 and (len(self._names["states"]) > 1 or words[0].text in self._names["states"]):
            self._start = dict.fromkeys(self._some("states", words[0], ("uniform",)), 1.0)
        else:
            row = self._distribution("states", words, statement)
            self._start = row and self._scaled(row, statement.keyword)

    def _scaled(self, row: Distribution, word: Word) -> Distribution:
        total = sum(row.values())
        if abs(total - 1) > _SUM_TOLERANCE:
            self._error("AOS122", f"the probabilities sum to {total:g}", word, "They have to sum to 1")
        return {number: probability / total for number, probability in row.items()}

    # --- rules ---

    def _rule(self, statement: Statement) -> None:
        keyword = statement.keyword.text
        kinds = {
            "T": ("actions", "states", "states"),
            "O": ("actions", "states", "observations"),
            "R": ("actions", "states", "states", *(() if self._is_seen else ("observations",))),
        }[keyword]
        fields = statement.fields
        least = 2 if keyword == "R" else 1
        if not least <= len(fields) <= len(kinds):
            wanted = " : ".join(kind.rstrip("s") for kind in kinds)
            message = f"`{keyword}:` has {len(fields)} fields"
            self._error("AOS106", message, statement.keyword, f"Write {keyword}: {wanted}, or its beginning")
            return
        last = fields[-1].text
        if not statement.words and last in _ROWS and last not in self._numbers[kinds[len(fields) - 1]]:
            before = " : ".join(word.text for word in fields[:-1])
            self._error("AOS106", f"a colon before {last}", fields[-1], f"Write `{keyword}: {before} {last}`")
            return
        chosen = [self._some(kind, word) for kind, word in zip(kinds, fields, strict=False)]
        if keyword == "R":
            self._reward(statement, chosen)
            return
        table = self._transitions if keyword == "T" else self._sensing
        if len(fields) == 3:
            value = self._probability(self._single(statement))
            for action in chosen[0]:
                for state in chosen[1]:
                    if (keyword, action, state) not in self._own:
                        # A row of a rule with wildcards is shared until one of its numbers changes.
                        table[action, state] = dict(table.get((action, state), {}))
                        self._own.add((keyword, action, state))
                    _put(table[action, state], chosen[2], value)
                    self._last_rule[keyword, action, state] = statement.keyword
            return
        states = chosen[1] if len(fields) == 2 else self._all("states")
        rows = self._rows(statement, kinds[2], states, is_matrix=len(fields) == 1)
        for action in chosen[0]:
            for state, row in zip(states, rows, strict=True):
                table[action, state] = row
                self._own.discard((keyword, action, state))
                self._last_rule[keyword, action, state] = statement.keyword

    def _rows(
        self, statement: Statement, kind: str, states: Sequence[int], *, is_matrix: bool
    ) -> Sequence[Distribution]:
        words = statement.words
        keyword = words[0].text if len(words) == 1 else ""
        if keyword == "uniform":
            return [self._uniform(kind)] * len(states)
        if keyword == "identity" and is_matrix and len(self._names[kind]) == len(self._names["states"]):
            return [{state: 1.0} for state in states]
        if keyword == "reset" and kind == "states":
            return [self._start or self._uniform(kind)] * len(states)
        if keyword[:1].isalpha():
            known = ("uniform", *(("identity", "reset") if kind == "states" else ()))
            hint = did_you_mean(keyword, known) or f"Write numbers, or one of {', '.join(known)}"
            self._error("AOS106", f"{keyword} stands for no probabilities here", words[0], hint)
            return [{} for _ in states]
        width = len(self._names[kind])
        if not is_matrix:
            return [self._distribution(kind, words, statement)] * len(states)
        if len(words) != width * len(states):
            message = f"{len(words)} numbers where {len(states)} rows of {width} are needed"
            self._error("AOS106", message, statement.keyword)
            return [{} for _ in states]
        return [
            self._distribution(kind, words[begin : begin + width], statement)
            for begin in range(0, len(words), width)
        ]

    def _reward(self, statement: Statement, chosen: list[Sequence[int]]) -> None:
        """A number, a row over observations, or a matrix over next states and observations.

        An MDP's rewards know no observations: a row is over next states.
        """
        observations = range(1) if self._is_seen else self._all("observations")
        numbers = [self._sign * self._number(word) for word in statement.words]
        rest = [self._all("states"), observations][len(chosen) - 2 :]
        wanted = int(np.prod([len(part) for part in rest], dtype=int))
        if len(numbers) != wanted:
            self._error("AOS106", f"{len(numbers)} numbers where {wanted} are needed", statement.keyword)
            return
        if not all(chosen):
            return  # a name that is unknown has been told
        words = zip(statement.fields, chosen, strict=True)
        choices = [None if word.text == "*" else numbers_of[0] for word, numbers_of in words]
        for place, number in enumerate(numbers):
            row, column = divmod(place, len(observations))
            observation = None if self._is_seen else column
            action, state, *tail = [*choices, *[row, observation][len(choices) - 2 :]]
            self._rewards.add(action, state, tail[0], tail[1], number)

    def _check(
        self, keyword: str, table: dict[tuple[int, int], Distribution], needed: set[tuple[int, int]]
    ) -> None:
        """Probabilities sum to 1 where that matters, and exactly so afterwards."""
        rows = {id(row): row for row in table.values()}
        totals = {number: sum(row.values()) for number, row in rows.items()}
        scaled: dict[int, Distribution] = {}
        lacking: list[str] = []
        for action, state in sorted(needed):
            row = table.get((action, state), {})
            total = totals.get(id(row), 0.0)
            if not row and (keyword, action, state) not in self._last_rule:
                lacking.append(self._row(keyword, action, state))
            elif abs(total - 1) > _SUM_TOLERANCE:
                message = f"the probabilities of `{self._row(keyword, action, state)}` sum to {total:g}"
                rule = self._last_rule.get((keyword, action, state), _WHOLE)
                self._error("AOS122", message, rule, "They have to sum to 1")
            elif total != 1:
                if id(row) not in scaled:
                    scaled[id(row)] = {number: p / total for number, p in row.items()}
                table[action, state] = scaled[id(row)]
        if lacking:
            others = f", nor {len(lacking) - 1} more" if len(lacking) > 1 else ""
            self._error("AOS105", f"there is no `{lacking[0]}`{others}", _WHOLE)

    # --- words ---

    def _row(self, keyword: str, action: int, state: int) -> str:
        return f"{keyword}: {self._names['actions'][action]} : {self._names['states'][state]}"

    def _all(self, kind: str) -> Sequence[int]:
        return range(len(self._names[kind]))

    def _uniform(self, kind: str) -> Distribution:
        return dict.fromkeys(self._all(kind), 1 / len(self._names[kind]))

    def _some(self, kind: str, word: Word, keywords: tuple[str, ...] = ()) -> Sequence[int]:
        """Returns the numbers that a name, a number or `*` stands for."""
        if word.text == "*":
            return self._all(kind)
        number = self._numbers[kind].get(word.text)
        if number is None and (count := word.count) is not None and count < len(self._names[kind]):
            number = count
        if number is None:
            self._findings.unknown(kind.rstrip("s"), word, self._names[kind], keywords)
            return ()
        return (number,)

    def _single(self, statement: Statement) -> Word:
        if len(statement.words) != 1:
            self._error("AOS106", f"{len(statement.words)} numbers where one is needed", statement.keyword)
        return statement.words[0] if statement.words else Word("0", statement.keyword.line, 0)

    def _distribution(self, kind: str, words: Sequence[Word], statement: Statement) -> Distribution:
        width = len(self._names[kind])
        if len(words) != width:
            message = f"{len(words)} numbers where {width} are needed"
            self._error("AOS106", message, statement.keyword, f"Write one for each of the {kind}")
            return {}
        values = (self._probability(word) for word in words)
        return {number: value for number, value in enumerate(values) if value > 0}

    def _probability(self, word: Word) -> float:
        value = self._number(word)
        if not 0 <= value <= 1 + 1e-9:
            self._error("AOS122", f"{word.text} is no probability", word)
            return 0.0
        return value

    def _number(self, word: Word) -> float:
        try:
            value = float(word.text)
        except ValueError:
            value = float("nan")
        if not np.isfinite(value):
            self._error("AOS106", f"{word.text} is not a finite number", word, advice_on_number(word.text))
            return 0.0
        return value


def _put(row: Distribution, numbers: Sequence[int], value: float) -> None:
    for number in numbers:
        if value > 0:
            row[number] = value
        else:
            row.pop(number, None)
