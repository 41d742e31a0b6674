"""Problems as documents: a hidden value goes through a chain of registers, one a step, by idioms of C++.

At last it decides about a reward, a response, a precondition or an ending. These matter, others do not. In
every second bundle two numbers are mission parameters, and the bundle means something with each of two
settings.
"""

import dataclasses
import random
from collections.abc import Sequence
from itertools import pairwise

from .idioms import IDIOMS, KINDS, Register
from .problem import GOAL, RUNNING, Outcome, State, World

SINKS = ("reward", "extrinsic_reward", "special_state", "goal", "response", "precondition", "draw")
"""The last register is read in one of these places."""

HORIZON = 5
WAIT, ONE, TWO = range(3)
YES, NO = range(2)
PENALTY = -7
PRIZE = 10


@dataclasses.dataclass(frozen=True)
class Documents:
    """A bundle, what it means with each setting of its mission parameters, and the variables that matter."""

    name: str
    files: dict[str, str]
    settings: tuple[tuple[dict[str, str], World], ...]
    relevant: frozenset[str]
    idioms: tuple[str, ...]


def documents(seed: int) -> Documents:
    source = random.Random(f"documents/{seed}")
    length = source.randint(2, 4)
    registers = [Register(f"r{i}", source.choice(KINDS)) for i in range(length)]
    dead = [Register(f"d{i}", source.choice(KINDS)) for i in range(source.randint(0, 2))]
    sink = source.choice(SINKS)
    share = source.choice((0.3, 0.4, 0.8))
    moves: dict[str, list[str]] = {"state_": [], "state__": []}
    used = []
    for before, after in [*pairwise(registers), *((source.choice(registers), d) for d in dead)]:
        state = "state_" if source.random() < 0.25 else "state__"
        name, code = _some_idiom(source, before, after, state)
        used.append(name)
        moves[state].append(code)
    for codes in moves.values():
        source.shuffle(codes)
    has_parameters = seed % 2 == 0
    files = _files(registers, dead, sink, "state.share" if has_parameters else repr(share), moves)
    settings: list[tuple[dict[str, str], World]] = [({}, _world(length, sink, share, PRIZE))]
    if has_parameters:
        _declare_parameters(files)
        settings = [
            ({"share": repr(odds), "prize": str(prize)}, _world(length, sink, odds, prize))
            for odds, prize in ((share, PRIZE), (1 - share, PRIZE // 2))
        ]
    relevant = {register.name for register in registers} | ({"answer"} if sink == "response" else set())
    return Documents(f"documents/{seed}", files, tuple(settings), frozenset(relevant), (*used, sink))


def _declare_parameters(files: dict[str, str]):
    declared = "mission_parameter: double share\ndefault_value: 0.125\n\nmission_parameter: int prize\n\n"
    files["chain.ef"] = files["chain.ef"].replace("initial_belief:", f"{declared}initial_belief:")
    files["act.sd"] = files["act.sd"].replace(f"? {PRIZE} : -{PRIZE}", "? state.prize : -state.prize")


def _some_idiom(source: random.Random, before: Register, after: Register, state: str) -> tuple[str, str]:
    names = list(IDIOMS)
    source.shuffle(names)
    for name in names:
        if (code := IDIOMS[name](before, after, state)) is not None:
            return name, code
    raise AssertionError("some idioms fit all registers")


def _files(
    registers: Sequence[Register],
    dead: Sequence[Register],
    sink: str,
    share: str,
    moves: dict[str, list[str]],
) -> dict[str, str]:
    last = registers[-1]
    extrinsic = list(moves["state_"])
    if sink == "extrinsic_reward":
        extrinsic.append(f"__reward = {last.read('state')} == 1 ? 2 : -1;")
    specials = ["if (state.done == 1) { __isGoalState = true; }"]
    if sink == "special_state":
        specials.append(f"if ({last.read('state')} == 1) {{ __reward = 3; }}")
    if sink == "goal":
        specials.insert(0, f"if ({last.read('state')} == 1) {{ __reward = -4; __isGoalState = true; }}")
    environment = [
        "project: chain",
        f"horizon: {HORIZON}",
        "discount: 0.9",
        "define_type: Light\nenum_members: Off, On",
        "define_type: Box\nvariable: int level 0\nvariable: bool spare false",
        *(register.declaration() for register in (*registers, *dead)),
        "state_variable: int done",
        *(["state_variable: int answer"] if sink == "response" else []),
        "initial_belief:",
        f"bool is_one = AOS.Bernoulli({share});",
        registers[0].write("state", "is_one ? 1 : 0"),
        *(["state.answer = is_one ? 1 : 0;"] if sink == "response" else []),
        "",
        *(["extrinsic_code:", *extrinsic, ""] if extrinsic else []),
        *(f"reward_code:\n{code}\n" for code in specials),
    ]
    mapping = [
        "project: chain",
        "response: yes\nresponse_rule: said == 'yes'",
        "response: no\nresponse_rule: True",
        "module_activation: skill\npath: /act",
        "local_variable: said\ntype: string\nfrom_ros_service_response: true\ncode:\nsaid = __input.text",
    ]
    return {
        "chain.ef": "\n\n".join(environment[:4])
        + "\n\n"
        + "\n".join([environment[4], "", *environment[5:], ""]),
        "act.sd": "\n".join([*_skill(registers[-1], sink, moves["state__"]), ""]),
        "act.am": "\n\n".join([*mapping, ""]),
    }


def _skill(last: Register, sink: str, moves: Sequence[str]) -> list[str]:
    value = last.read("state")
    earned = {
        "reward": f"{value} == 1 ? {PRIZE} : -{PRIZE}",
        "draw": f"AOS.Bernoulli(0.2 + 0.6 * {value}) ? {PRIZE} : -{PRIZE}",
        "response": f"state.answer == 2 - choice ? {PRIZE} : -{PRIZE}",
    }.get(sink, "1")
    return [
        "project: chain",
        "parameter: int choice",
        "",
        "available_parameters_code:",
        "for (int i = 0; i < 3; i++) __possibleParameters.push_back(std::make_tuple(i));",
        "",
        *(
            ["precondition:", f"__meetPrecondition = {value} == 0;", f"violate_penalty: {PENALTY}", ""]
            if sink == "precondition"
            else []
        ),
        "dynamic_model:",
        *moves,
        *(
            [f"__moduleResponse = {value} == 1 ? yes : no;"]
            if sink == "response"
            else ["__moduleResponse = no;"]
        ),
        "__reward = -0.1;",
        f"if (choice > 0) {{ state__.done = 1; __reward = {earned}; }}",
    ]


def _world(length: int, sink: str, share: float, prize: int) -> World:
    def step(state: State, action: int) -> list[Outcome]:
        answer, *now = state
        value = now[-1]
        after = [now[0], *now[:-1]]
        reward = -0.1
        odds = [(1.0, 0.0)]
        if action != WAIT:
            odds = {
                "reward": [(1.0, float(prize if value else -prize))],
                "draw": [(0.2 + 0.6 * value, float(prize)), (0.8 - 0.6 * value, float(-prize))],
                "response": [(1.0, float(prize if answer == 2 - action else -prize))],
            }.get(sink, [(1.0, 1.0)])
            reward = 0.0
        if sink == "extrinsic_reward":
            reward += 2 if value else -1
        if sink == "precondition" and value:
            reward += PENALTY
        ends = action != WAIT
        if sink == "special_state" and after[-1]:
            reward += 3
        if sink == "goal" and after[-1]:
            reward -= 4
            ends = True
        observation = YES if sink == "response" and value else NO
        ending = GOAL if ends else RUNNING
        return [
            Outcome(part, (answer, *after), reward + earned, observation, ending) for part, earned in odds
        ]

    zeros = (0,) * (length - 1)
    starts = [(share, (1, 1, *zeros)), (1 - share, (0, 0, *zeros))]
    names = ("answer", *(f"r{i}" for i in range(length)))
    return World("documents", 0.9, HORIZON, names, ("wait", "one", "two"), starts, step)
