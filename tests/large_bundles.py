"""Bundles of a size that nobody writes by hand: many state variables, or one long array."""

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
