"""Books that are sorted by swaps, with noisy scans; the end pays by how many stand right."""

import random

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_TRUE = 0.75


def sorting(count: int = 10) -> Bundle:
    """The robot may close at any time, which pays where four books or more stand right."""
    writer = BundleWriter(
        "sorting",
        f"""horizon: 60
discount: 0.99

state_variable: int book []
code:
state.book.assign({count}, 0);

state_variable: bool is_done

initial_belief:
for (int i = 0; i < {count}; i++) state.book[i] = i;
for (int i = {count} - 1; i > 0; i--) {{
    vector<double> odds(i + 1, 1.0);
    int j = AOSUtils::SampleDiscrete(odds);
    std::swap(state.book[i], state.book[j]);
}}

reward_code:
if (state.is_done) __isGoalState = true;
""",
    )
    swap = """__reward = -0.5;
std::swap(state__.book[one], state__.book[other]);
__moduleResponse = swapped;"""
    writer.skill("swap", ["swapped"], swap, over={"one": str(count), "other": "one"})
    names = [f"book_{i}" for i in range(count)]
    tell = " : ".join(f"told == {i} ? {name}" for i, name in enumerate(names[:-1]))
    scan = f"""__reward = -0.3;
int told = state.book[at];
if (!AOS.Bernoulli({_TRUE})) told = (told + (AOS.Bernoulli(0.5) ? 1 : {count - 1})) % {count};
__moduleResponse = {tell} : {names[-1]};"""
    writer.skill("scan", names, scan, over={"at": str(count)})
    close = f"""__reward = -12;
for (int i = 0; i < {count}; i++) if (state.book[i] == i) __reward += 4;
state__.is_done = true;
__moduleResponse = closed;"""
    writer.skill("close", ["closed"], close)
    return writer.files


class Sorting(World):
    """The shelf as the documents describe it; a swap has the value `count * one + other`."""

    discount = 0.99

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.books = list(range(count))
        rng.shuffle(self.books)

    def actions(self) -> list[tuple[str, int]]:
        n = len(self.books)
        swaps = [("swap", i * n + j) for i in range(n) for j in range(i)]
        return [*swaps, *(("scan", i) for i in range(n)), ("close", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        n = len(self.books)
        if skill == "swap":
            i, j = divmod(value, n)
            self.books[i], self.books[j] = self.books[j], self.books[i]
            self.gain(-0.5)
            return ""
        if skill == "scan":
            told = self.books[value]
            if self.rng.random() >= _TRUE:
                told = (told + self.rng.choice((1, n - 1))) % n
            self.gain(-0.3)
            return str(told)
        self.has_ended = True
        self.gain(-12 + 4 * sum(book == i for i, book in enumerate(self.books)))
        return ""


def sorting_rule(count: int, rng: random.Random) -> float:
    """Scans each place until a book has 0.9 there (each place by itself), sorts by swaps, and closes."""
    world = Sorting(count, rng)
    odds = np.full((count, count), 1 / count)
    for at in range(count):
        while odds[at].max() < 0.9 and not world.is_over:
            told = int(world.act("scan", at))
            like = np.zeros(count)
            like[told] = _TRUE
            like[(told + 1) % count] = like[(told - 1) % count] = (1 - _TRUE) / 2
            odds[at] *= like + 1e-9
            odds[at] /= odds[at].sum()
    books, free = [0] * count, odds.copy()
    for _ in range(count):  # the surest pair first
        i, j = divmod(int(free.argmax()), count)
        books[i] = j
        free[i, :] = free[:, j] = -1
    for i in range(count):
        if books[i] != i and not world.is_over:
            j = books.index(i)
            world.act("swap", max(i, j) * count + min(i, j))
            books[i], books[j] = books[j], books[i]
    if not world.is_over:
        world.act("close")
    return world.earned
