"""Random programs of nested loops that draw, as C++ and as closed forms.

A program has three numbers from 0 to 2. Its loops end when one of them is drawn as it should be. In their
bodies there are draws whose odds depend on the others, and further loops. The closed form of a loop is that
of an absorbing chain over the numbers at its head, by fractions.
"""

from collections import defaultdict
from collections.abc import Callable
from fractions import Fraction
from random import Random

Numbers = tuple[int, ...]
Odds = dict[Numbers, Fraction]
Meaning = Callable[[Odds], Odds]
_NAMES = "xyz"


def loop_program(seed: int, loops: int, depth: int) -> tuple[str, Callable[[int], dict[int, Fraction]]]:
    """Returns C++ from `x`, which is declared before it, to `spot`, and the odds of `spot` by that of `x`.

    There are so many loops, one after the other, each with loops in it to that depth.
    """
    random = Random(seed)
    texts, meanings = zip(*(_loop(random, number % 3, depth) for number in range(loops)), strict=True)
    text = "\n".join(["int y = 0; int z = 0;", *texts, "int spot = x + 3 * y + 9 * z;"])

    def odds_of(x: int) -> dict[int, Fraction]:
        odds: Odds = {(x, 0, 0): Fraction(1)}
        for meaning in meanings:
            odds = meaning(odds)
        return {x + 3 * y + 9 * z: share for (x, y, z), share in odds.items()}

    return text, odds_of


def _loop(random: Random, number: int, depth: int) -> tuple[str, Meaning]:
    end = random.randrange(3)
    others = [(number + 1) % 3, (number + 2) % 3]
    parts = [_turn(random, random.choice(others), random.randrange(3)) for _ in range(random.randrange(1, 3))]
    if depth > 1:
        parts.insert(random.randrange(len(parts) + 1), _loop(random, random.choice(others), depth - 1))
    parts.append(_draw(random, number, end))
    body = " ".join(text for text, _ in parts)
    name = _NAMES[number]
    is_first_free = random.random() < 0.5
    goes_on = f"while ({name} != {end})"
    text = f"do {{ {body} }} {goes_on};" if is_first_free else f"{goes_on} {{ {body} }}"

    def once(odds: Odds) -> Odds:
        for _, meaning in parts:
            odds = meaning(odds)
        return odds

    def until_end(odds: Odds) -> Odds:
        return _absorbed(once(odds) if is_first_free else odds, once, lambda numbers: numbers[number] == end)

    return text, until_end


def _draw(random: Random, number: int, end: int) -> tuple[str, Meaning]:
    weights = [random.randrange(4) for _ in range(3)]
    weights[end] += 1

    def meaning(odds: Odds) -> Odds:
        after: Odds = defaultdict(Fraction)
        for numbers, share in odds.items():
            for value, weight in enumerate(weights):
                after[_with(numbers, number, value)] += share * Fraction(weight, sum(weights))
        return _possible(after)

    listed = ", ".join(f"{weight}.0" for weight in weights)
    return f"{_NAMES[number]} = AOS.SampleDiscrete(-1, {{{listed}}});", meaning


def _turn(random: Random, number: int, by: int) -> tuple[str, Meaning]:
    step = random.randrange(1, 3)

    def meaning(odds: Odds) -> Odds:
        after: Odds = defaultdict(Fraction)
        for numbers, share in odds.items():
            turns = Fraction(1 + numbers[by], 4)
            after[_with(numbers, number, (numbers[number] + step) % 3)] += share * turns
            after[numbers] += share * (1 - turns)
        return _possible(after)

    name = _NAMES[number]
    return f"if (AOS.Bernoulli(0.25 * (1 + {_NAMES[by]}))) {name} = ({name} + {step}) % 3;", meaning


def _absorbed(odds: Odds, once: Meaning, is_end: Callable[[Numbers], bool]) -> Odds:
    rows: dict[Numbers, Odds] = {}
    waiting = [numbers for numbers in odds if not is_end(numbers)]
    while waiting:
        numbers = waiting.pop()
        if numbers in rows:
            continue
        rows[numbers] = once({numbers: Fraction(1)})
        waiting += [after for after in rows[numbers] if not is_end(after)]
    heads = list(rows)
    # How often a round begins with each head: visits = odds + visits * rows.
    system = [[Fraction(one == other) - rows[other].get(one, Fraction()) for other in heads] for one in heads]
    visits = solved(system, [odds.get(head, Fraction()) for head in heads])
    ends: Odds = defaultdict(Fraction, {numbers: share for numbers, share in odds.items() if is_end(numbers)})
    for head, often in zip(heads, visits, strict=True):
        for after, share in rows[head].items():
            if is_end(after):
                ends[after] += often * share
    return _possible(ends)


def solved(system: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """The solution of linear equations, by Gauss and Jordan."""
    rows = [[*row, value] for row, value in zip(system, right, strict=True)]
    for column in range(len(rows)):
        pivot = next(index for index in range(column, len(rows)) if rows[index][column])
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for index, row in enumerate(rows):
            if index != column:
                rows[index] = [value - row[column] * at for value, at in zip(row, rows[column], strict=True)]
    return [row[-1] for row in rows]


def _with(numbers: Numbers, number: int, value: int) -> Numbers:
    return (*numbers[:number], value, *numbers[number + 1 :])


def _possible(odds: Odds) -> Odds:
    return {numbers: share for numbers, share in odds.items() if share}
