"""Bundles of a size that nobody writes by hand: many state variables, or one long array.

python tests/large_bundles.py: how long they take to check, to build and to update. The engine has to be
compiled before, as set-up does it.
"""

import asyncio
import sys
import time
from collections.abc import Mapping

from models import built_text, engine_of
from texts import encoded

from aos_language.load import load_files

_VALUES = {"int": "7", "bool": "true", "double": "0.5", "Level": "High", "string": '"a"', "Cup": "Cup{true}"}
_TYPES = tuple(_VALUES)

_ENVIRONMENT = """project: large
horizon: 5
discount: 0.95
define_type: Level
enum_members: Low, Middle, High
define_type: Cup
variable: bool is_full false
"""
_SKILL = """project: large
parameter: int at
available_parameters_code:
for (int at = 0; at < 3; at++) __possibleParameters.push_back(std::make_tuple(at));
dynamic_model:
"""


def many_variables(count: int) -> dict[str, str]:
    """Variables of all kinds. A step sets the one of its parameter, and tells with some noise what v0 is."""
    kinds = [_TYPES[number % len(_TYPES)] for number in range(count)]
    declared = [f"state_variable: {kind} v{number}" for number, kind in enumerate(kinds)]
    set_one = [
        f"if (at == {number}) state__.v{number} = {_VALUES[kind]};" for number, kind in enumerate(kinds)
    ]
    response = "__moduleResponse = AOS.Bernoulli(0.9) == (state.v0 == 1) ? one : two;"
    initial = "initial_belief:\nstate.v0 = AOS.Bernoulli(0.5) ? 1 : 2;"
    return _bundle([*declared, initial], [*set_one, response])


def long_array(size: int, drawn: int = 1) -> dict[str, str]:
    """Zeros, of which the first `drawn` may be ones; a step tells with some noise what the first is."""
    declared = f"state_variable: int grid []\ncode:\nstate.grid = std::vector<int>({size}, 0);"
    initial = (
        f"initial_belief:\nfor (int i = 0; i < {drawn}; i++) state.grid[i] = AOS.Bernoulli(0.5) ? 1 : 0;"
    )
    response = "__moduleResponse = AOS.Bernoulli(0.9) == (state.grid[0] == 1) ? one : two;"
    return _bundle([declared, initial], [f"state__.grid[at + {size // 2}] += 1;", response])


def _bundle(environment: list[str], dynamic_model: list[str]) -> dict[str, str]:
    return {
        "large.ef": _ENVIRONMENT + "\n".join(environment) + "\n",
        "act.sd": _SKILL + "\n".join(dynamic_model) + "\n",
    }


async def _measure(title: str, files: Mapping[str, str]) -> None:
    checking_s = time.perf_counter()
    load_files(encoded(files))
    building_s = time.perf_counter()
    built = await built_text(files)
    built_s = time.perf_counter()
    sys.stdout.write(
        f"{title}: checked in {building_s - checking_s:.2f} s, built in {built_s - building_s:.2f} s"
    )
    async with engine_of(built) as engine:
        for _ in range(3):
            begun_s = time.perf_counter()
            states = (await engine.update("act(at=1)", "one")).summary.states
            sys.stdout.write(f", {states} states updated in {time.perf_counter() - begun_s:.3f} s")
    sys.stdout.write("\n")


async def _main() -> None:
    await _measure("1,000 variables", many_variables(1_000))
    await _measure("10,000 elements", long_array(10_000))
    await _measure("10,000 elements, 10 drawn", long_array(10_000, drawn=10))


if __name__ == "__main__":
    asyncio.run(_main())
