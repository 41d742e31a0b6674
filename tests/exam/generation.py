import random
from collections.abc import Sequence
from contextlib import suppress

from .disguises import disguised
from .families import FAMILIES
from .problem import Problem, TooLarge, tabulate


def named_problem(name: str, max_states: int) -> Problem:
    """The problem FAMILY/SEED, or FAMILY+/SEED, the large one; TooLarge where it has more states."""
    family, _, seed = name.partition("/")
    if family.removesuffix("+") not in FAMILIES or not seed.isdigit():
        raise SystemExit(f"exam: '{name}' is no FAMILY/SEED; families are {', '.join(FAMILIES)}")
    source = random.Random(name)
    world = FAMILIES[family.removesuffix("+")](source, family.endswith("+"))
    return tabulate(name, disguised(source, world), max_states)


def problems(families: Sequence[str], count: int, seed: int, large: bool, max_states: int) -> list[Problem]:
    """So many, the families in turn; those with too many states give way to the next seed."""
    found: list[Problem] = []
    while len(found) < count:
        family = families[len(found) % len(families)]
        # Where not all are to be large, every third one is.
        mark = "+" if large or len(found) // len(families) % 3 == 2 else ""
        with suppress(TooLarge):
            found.append(named_problem(f"{family}{mark}/{seed}", 20_000 if large else max_states))
        seed += 1
    return found
