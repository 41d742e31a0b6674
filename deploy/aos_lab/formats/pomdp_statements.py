"""The statements of a `.pomdp` file, as words, and the model that their tables say."""

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise

import msgspec
import numpy as np

from aos_lab.formats.problem_text import ProblemFindings, Word
from aos_protocol.spelling import nearest
from aos_solver.offline.explicit_model import ExplicitModel, Ragged, StartBelief

Choice = int | None
"""A number, or None for all."""
Tail = tuple[Choice, Choice]
"""A next state and an observation."""


class RewardRules:
    """Rules by what they are for. A rule for all of a kind is one entry, however many that are."""

    def __init__(self) -> None:
        self._rules: dict[tuple[Choice, Choice], dict[Tail, tuple[int, float]]] = {}
        self._count = 0

    def add(self, action: Choice, state: Choice, after: Choice, observation: Choice, reward: float) -> None:
        """A rule that overrides those before it."""
        self._count += 1
        self._rules.setdefault((action, state), {})[after, observation] = self._count, reward

    def expected(
        self,
        action: int,
        state: int,
        transitions: Mapping[int, float],
        sensing: Callable[[int], Mapping[int, float]],
    ) -> float:
        """The expected reward; `sensing` gives the observations of a next state."""
        heads = ((action, state), (action, None), (None, state), (None, None))
        tables = [self._rules[head] for head in heads if head in self._rules]
        plain = max((table[None, None] for table in tables if (None, None) in table), default=(0, 0.0))
        tables = [table for table in tables if len(table) > ((None, None) in table)]
        if not tables:
            return plain[1]
        total = 0.0
        for after, probability in transitions.items():
            for observation, chance in sensing(after).items():
                tails = ((after, observation), (after, None), (None, observation))
                fitting = (table[tail] for table in tables for tail in tails if tail in table)
                total += probability * chance * max((plain, *fitting))[1]
        return total


_VARIANTS = ("include", "exclude")
_WORD = re.compile(r"[^\s:]+|:")
KEYWORDS = frozenset({"discount", "values", "states", "actions", "observations", "start", "T", "O", "R"})


class Statement(msgspec.Struct, frozen=True):
    """A keyword, the fields between colons, and the words after the last field.

    The words of `T: a : s 0.1 0.9` are its last two; of `states: left right` all. `variant` is `include` or
    `exclude` of `start`.
    """

    keyword: Word
    variant: str
    fields: tuple[Word, ...]
    words: tuple[Word, ...]


def statements_of(text: str, findings: ProblemFindings) -> Iterator[Statement]:
    """The statements in order; words outside of any, and keywords that there are not, are findings.

    A statement whose keyword is mistyped, or lacks its colon, is read nevertheless: that is one mistake.
    """
    words = list(_words(text))
    begin_one = (_begins, _lacks_colon, _is_no_keyword)
    starts = [place for place in range(len(words)) if any(begins(words, place) for begins in begin_one)]
    if words and starts[:1] != [0]:
        starts.insert(0, 0)
    for begin, end in pairwise([*starts, len(words)]):
        word, rest = words[begin], words[begin + 1 : end]
        if _begins(words, begin):
            yield _statement([word, *rest])
        elif _lacks_colon(words, begin):
            is_start = word.text == "start"
            variant = [each for each in rest[:1] if is_start and each.text in _VARIANTS]
            said = " ".join(each.text for each in (word, *variant))
            findings.error("AOS102", f"{word.text} begins a line without a colon", word, f"Write `{said}:`")
            colon = Word(":", word.line, word.column)
            yield _statement([word, *variant, colon, *rest[len(variant) :]])
        else:
            meant = nearest(word.text, KEYWORDS) if rest[:1] and rest[0].text == ":" else ""
            hint = f"Did you mean `{meant}`?" if meant else "Expected discount:, states:, T: and their like"
            findings.error("AOS102", f"{word.text} is no keyword", word, hint)
            if meant:
                yield _statement([Word(meant, word.line, word.column), *rest])


def _words(text: str) -> Iterator[Word]:
    for number, line in enumerate(text.split("\n"), start=1):
        for match in _WORD.finditer(line.partition("#")[0]):
            yield Word(match.group(), number, match.start() + 1)


def _begins(words: list[Word], place: int) -> bool:
    """Returns whether a statement begins here: a keyword that a colon follows, and that is no field
    itself."""
    if words[place].text not in KEYWORDS or (place > 0 and words[place - 1].text == ":"):
        return False
    following = [word.text for word in words[place + 1 : place + 3]]
    if following[:1] == [":"]:
        return True
    return words[place].text == "start" and following[0:1] in (["include"], ["exclude"]) and ":" in following


def _lacks_colon(words: list[Word], place: int) -> bool:
    """Returns whether a line begins here with a keyword that no colon follows."""
    before = words[place - 1] if place > 0 else None
    is_first = before is None or (before.line < words[place].line and before.text != ":")
    return is_first and words[place].text in KEYWORDS and not _begins(words, place)


def _is_no_keyword(words: list[Word], place: int) -> bool:
    """Returns whether a line begins here as a statement does, with a word that is no keyword."""
    word, following = words[place], words[place + 1 : place + 2]
    before = words[place - 1] if place > 0 else None
    is_first = before is None or (before.line < word.line and before.text != ":")
    is_keyword = word.text in KEYWORDS or word.text == ":"
    return is_first and not is_keyword and [each.text for each in following] == [":"]


def _statement(words: list[Word]) -> Statement:
    keyword, rest = words[0], words[1:]
    variant = ""
    if rest[0].text != ":":
        variant, rest = rest[0].text, rest[1:]
    rest = rest[1:]
    fields: list[Word] = []
    if keyword.text in ("T", "O", "R"):
        while rest and rest[0].text != ":":
            fields.append(rest[0])
            rest = rest[1:]
            if not (rest and rest[0].text == ":"):
                break
            rest = rest[1:]
    return Statement(keyword, variant, tuple(fields), tuple(rest))


Distribution = dict[int, float]


class PomdpTables(msgspec.Struct, frozen=True):
    """The probabilities of next states by action and state, and of observations by action and next state; the
    rewards, and the start. Where all `is_seen`, whoever acts sees the state."""

    transitions: Mapping[tuple[int, int], Distribution]
    sensing: Mapping[tuple[int, int], Distribution]
    rewards: RewardRules
    start: Distribution
    is_seen: bool

    def sensing_of(self, action: int) -> Callable[[int], Distribution]:
        """The observations after an action, by the next state."""
        return lambda state: self.sensing[action, state]


def explicit_model(
    name: str, discount: float, names: Mapping[str, tuple[str, ...]], tables: PomdpTables
) -> ExplicitModel:
    """The model of complete tables; `names` are those of states, actions and observations."""
    actions, states = names["actions"], names["states"]
    known: dict[tuple[tuple[int, float], ...], int] = {}
    first, after, chances, sensings = [0], [], [], []
    rewards = np.zeros((len(states), len(actions)))
    for state in range(len(states)):
        for action in range(len(actions)):
            row = tables.transitions[action, state]
            for number, probability in sorted(row.items()):
                if probability <= 0:
                    continue
                sensing = tuple(sorted(tables.sensing[action, number].items()))
                after.append(number)
                chances.append(probability)
                sensings.append(known.setdefault(sensing, len(known)))
            first.append(len(after))
            rewards[state, action] = tables.rewards.expected(action, state, row, tables.sensing_of(action))
    likelihoods = Ragged(
        np.cumsum([0, *(len(row) for row in known)]),
        np.array([number for row in known for number, _ in row], dtype=np.int64),
        np.array([probability for row in known for _, probability in row]),
    )
    return ExplicitModel(
        name=name,
        discount=discount,
        states=states,
        actions=actions,
        observations=names["observations"],
        rewards=rewards,
        outcomes=Ragged(np.array(first), np.array(after), np.array(chances)),
        sensings=np.array(sensings),
        likelihoods=likelihoods,
        starts=_starts(tables),
    )


def _starts(tables: PomdpTables) -> tuple[StartBelief, ...]:
    if tables.is_seen:
        one = np.ones(1)
        return tuple(
            StartBelief(probability, np.array([state]), one)
            for state, probability in sorted(tables.start.items())
        )
    return (StartBelief(1.0, np.array(list(tables.start)), np.array(list(tables.start.values()))),)
