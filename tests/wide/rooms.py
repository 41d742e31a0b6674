"""Measures planners on chains of random rooms, whose states cannot be listed and whose exact value is known.

python -m tests.wide.rooms                    # chains 1 to 6, four missions each
python -m tests.wide.rooms 2 --planner pomcp --runs 8

Each of 16 rooms hides one of four values, all drawn when the mission begins. Four actions tell of the value
of the room at hand, and may change it. To leave pays or costs by the value, and leads to the next room.
Nothing that is observed in a room tells of another one. So a room is a small model by itself, in which
to leave is worth what it pays and what the rooms behind it are worth. SARSOP solves the last one first.
"""

import argparse
import asyncio
import dataclasses
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import msgspec

from .__main__ import _text
from .missions import played
from .writing import Bundle, BundleWriter

ROOMS, VALUES, ACTIONS, SIGNS = 16, 4, 4, 3
DISCOUNT = 0.95
_STEPS = 400
_AOS = Path(sys.executable).with_name("aos")

_Table = float | list["_Table"]


@dataclasses.dataclass(frozen=True)
class Room:
    """Chances of values, of what actions make of them, and of signs; costs of actions, pay for leaving."""

    prior: list[float]
    moves: list[list[list[float]]]  # [action][value][next value]
    signs: list[list[list[float]]]  # [action][next value][sign]
    costs: list[float]
    pays: list[float]


def chain(seed: int) -> list[Room]:
    """The rooms of a chain, the first one first."""
    rng = random.Random(seed)
    return [_room(rng) for _ in range(ROOMS)]


def _room(rng: random.Random) -> Room:
    prior = _probabilities(rng, VALUES, 1)
    moves, signs, costs = [], [], []
    for _ in range(ACTIONS):
        is_move = rng.random() < 0.5
        moves.append([_moved(rng) if is_move else _certain(value) for value in range(VALUES)])
        sharpness = rng.choice((0, 1, 3) if is_move else (1, 3))
        signs.append([_probabilities(rng, SIGNS, sharpness) for _ in range(VALUES)])
        costs.append(round(-rng.uniform(0.1, 1.0), 3))
    return Room(prior, moves, signs, costs, [round(rng.uniform(-10, 10), 2) for _ in range(VALUES)])


def _moved(rng: random.Random) -> list[float]:
    """Most of the probability goes to one value."""
    share = rng.uniform(0.5, 0.95)
    chances = [(1 - share) * chance for chance in _probabilities(rng, VALUES, 2)]
    chances[rng.randrange(VALUES)] += share
    return chances


def _certain(value: int) -> list[float]:
    return [float(other == value) for other in range(VALUES)]


def _probabilities(rng: random.Random, count: int, sharpness: int) -> list[float]:
    weights = [rng.expovariate(1) ** sharpness for _ in range(count)]
    chances = [round(weight / sum(weights), 4) for weight in weights]
    chances[0] += 1 - sum(chances)
    return chances


def bundle_of(rooms: list[Room]) -> Bundle:
    """The documents of a chain."""
    draws = "\n".join(
        f"{{ vector<double> odds {_cpp(room.prior)}; state.hidden[{at}] = AOSUtils::SampleDiscrete(odds); }}"
        for at, room in enumerate(rooms)
    )
    writer = BundleWriter(
        "rooms",
        f"""horizon: 60
discount: {DISCOUNT}

state_variable: int room
state_variable: int hidden []
code:
state.hidden.assign({ROOMS}, 0);

initial_belief:
{draws}

reward_code:
if (state.room == {ROOMS}) __isGoalState = true;
""",
    )
    signs = [f"sign_{i}" for i in range(SIGNS)]
    told = " : ".join(f"sign == {i} ? {name}" for i, name in enumerate(signs[:-1]))
    table = f"{ROOMS}][{ACTIONS}][{VALUES}"
    act = f"""static const double moves[{table}][{VALUES}] = {_cpp([r.moves for r in rooms])};
static const double signs[{table}][{SIGNS}] = {_cpp([r.signs for r in rooms])};
static const double costs[{ROOMS}][{ACTIONS}] = {_cpp([r.costs for r in rooms])};
int at = state.room;
const double* next = moves[at][which][state.hidden[at]];
vector<double> odds(next, next + {VALUES});
int value = AOSUtils::SampleDiscrete(odds);
state__.hidden[at] = value;
vector<double> chances(signs[at][which][value], signs[at][which][value] + {SIGNS});
int sign = AOSUtils::SampleDiscrete(chances);
__reward = costs[at][which];
__moduleResponse = {told} : {signs[-1]};"""
    writer.skill("act", signs, act, over={"which": str(ACTIONS)})
    leave = f"""static const double pays[{ROOMS}][{VALUES}] = {_cpp([r.pays for r in rooms])};
__reward = pays[state.room][state.hidden[state.room]];
state__.room = state.room + 1;
__moduleResponse = left;"""
    writer.skill("leave", ["left"], leave)
    return writer.files


def _cpp(table: _Table) -> str:
    return "{" + ", ".join(map(_cpp, table)) + "}" if isinstance(table, list) else f"{table:.6f}"


def exact_value(rooms: list[Room], folder: Path) -> float:
    """The mean return of an optimal robot, within 0.1."""
    value = 0.0
    for room in reversed(rooms):
        file = folder / "room.pomdp"
        file.write_text(_pomdp(room, DISCOUNT * value))
        command = [str(_AOS), "solve", str(file), "--json", "--precision", "0.005", "--out", f"{file}.policy"]
        solved = msgspec.json.decode(subprocess.run(command, check=True, capture_output=True).stdout)
        value = (solved["lower"] + solved["upper"]) / 2
    return value


def _pomdp(room: Room, later: float) -> str:
    """A room by itself in Cassandra's format. To leave is also worth `later`."""
    lines = [
        f"discount: {DISCOUNT}",
        "values: reward",
        f"states: {VALUES + 1}",
        f"actions: {ACTIONS + 1}",
        f"observations: {SIGNS}",
        f"start: {' '.join(map(str, room.prior))} 0",
        f"T: {ACTIONS} : * : {VALUES} 1",
        f"O: {ACTIONS} : * : 0 1",
    ]
    for action in range(ACTIONS):
        lines += [f"T: {action} : {VALUES} : {VALUES} 1", f"O: {action} : {VALUES} : 0 1"]
        for value in range(VALUES):
            moves, signs = room.moves[action][value], room.signs[action][value]
            lines += [f"T: {action} : {value} : {other} {chance:.9f}" for other, chance in enumerate(moves)]
            lines += [f"O: {action} : {value} : {sign} {chance:.9f}" for sign, chance in enumerate(signs)]
            lines.append(f"R: {action} : {value} : * : * {room.costs[action]}")
    lines += [f"R: {ACTIONS} : {value} : * : * {pay + later:.6f}" for value, pay in enumerate(room.pays)]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Prints the exact value of each chain, and what missions return."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("chain", nargs="*", type=int, default=range(1, 7))
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--time", type=float, default=0.1)
    parser.add_argument("--planner", default="auto")
    arguments = parser.parse_args()
    for seed in arguments.chain:
        rooms = chain(seed)
        with tempfile.TemporaryDirectory() as folder:
            exact = exact_value(rooms, Path(folder))
        with tempfile.TemporaryDirectory() as folder:
            for name, text in bundle_of(rooms).items():
                (Path(folder) / name).write_text(text)
            seeds = range(1, arguments.runs + 1)
            found = asyncio.run(played(Path(folder), arguments.planner, arguments.time, seeds, _STEPS))
        print(f"chain {seed}: exact {exact:.1f}, {_text(found)}", flush=True)


if __name__ == "__main__":
    main()
