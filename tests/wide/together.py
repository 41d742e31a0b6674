"""Problems that earn only when many things are right together: objects in a bin, lamps.

The search that counts conditions was not tuned for them.
"""

import random
from collections.abc import Callable

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

_SPOTS = 12
_SEES = 0.9
_COLOURS = 4
_TRUE = 0.85
_DISCOUNT = 0.99


def _head(horizon: int, arrays: dict[str, tuple[str, int, str]], numbers: tuple[str, ...] = ()) -> str:
    """The first lines of an environment document; `arrays` have a type, a length and a first value."""
    lines = [f"horizon: {horizon}\ndiscount: {_DISCOUNT}\n"]
    for name, (kind, length, value) in arrays.items():
        lines.append(f"state_variable: {kind} {name} []\ncode:\nstate.{name}.assign({length}, {value});\n")
    lines += [f"state_variable: int {number}\n" for number in numbers]
    return "\n".join(lines)


def tidy(count: int = 6) -> Bundle:
    """Objects lie at twelve spots, unseen; one after the other is carried to the bin, which is at spot 0."""
    writer = BundleWriter(
        f"tidy{count}",
        _head(100, {"at": ("int", count, "0"), "in_bin": ("bool", count, "false")}, ("robot", "held"))
        + f"""
initial_belief:
for (int i = 0; i < {count}; i++) state.at[i] = AOSUtils::SampleDiscrete(vector<double>({_SPOTS}, 1.0));
state.held = -1;

reward_code:
bool all_in_bin = true;
for (int i = 0; i < {count}; i++) if (!state.in_bin[i]) all_in_bin = false;
if (all_in_bin) {{
    __isGoalState = true;
    __reward = 100;
}}
""",
    )
    go = "__reward = -0.3;\nstate__.robot = spot;\n__moduleResponse = there;"
    writer.skill("go", ["there"], go, over={"spot": str(_SPOTS)})
    free = f"""int found = -1;
for (int i = {count} - 1; i >= 0; i--) {{
    if (state.at[i] == state.robot && !state.in_bin[i] && state.held != i) found = i;
}}
"""
    scan = (
        f"{free}__reward = -0.2;\n__moduleResponse = found >= 0 && AOS.Bernoulli({_SEES}) ? object : nothing;"
    )
    writer.skill("scan", ["object", "nothing"], scan)
    pick = f"""{free}if (found >= 0 && state.held < 0) {{
    state__.held = found;
    __reward = -0.3;
    __moduleResponse = picked;
}} else {{
    __reward = -1;
    __moduleResponse = empty;
}}"""
    writer.skill("pick", ["picked", "empty"], pick)
    drop = """__reward = -0.3;
__moduleResponse = nothing;
if (state.held >= 0) {
    state__.at[state.held] = state.robot;
    if (state.robot == 0) state__.in_bin[state.held] = true;
    state__.held = -1;
    __moduleResponse = dropped;
}"""
    writer.skill("drop", ["dropped", "nothing"], drop)
    return writer.files


class Tidy(World):
    """The room as the documents describe it."""

    discount = _DISCOUNT

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.at = [rng.randrange(_SPOTS) for _ in range(count)]
        self.left = set(range(count))
        self.robot, self.held = 0, -1

    def actions(self) -> list[tuple[str, int]]:
        return [*(("go", spot) for spot in range(_SPOTS)), ("scan", 0), ("pick", 0), ("drop", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        here = [i for i in sorted(self.left) if self.at[i] == self.robot and i != self.held]
        told, reward = "", -0.3
        if skill == "go":
            self.robot = value
        elif skill == "scan":
            told, reward = "object" if here and self.rng.random() < _SEES else "", -0.2
        elif skill == "pick":
            told, reward = ("picked", -0.3) if here and self.held < 0 else ("", -1)
            self.held = here[0] if told else self.held
        elif self.held >= 0:
            self.at[self.held] = self.robot
            self.left -= {self.held} if self.robot == 0 else set()
            self.held = -1
            reward += 0 if self.left else 100
        self.has_ended = not self.left
        self.gain(reward)
        return told


def tidy_rule(count: int, rng: random.Random) -> float:
    """Scans each spot, carries what it finds to the bin, and looks there again, up to two scans in vain."""
    world = Tidy(count, rng)
    while not world.is_over:
        for spot in range(_SPOTS):
            is_clear = False
            while not is_clear and not world.is_over:
                if world.robot != spot:
                    world.act("go", spot)
                is_clear = not (world.act("scan") or world.act("scan"))
                if not is_clear and world.act("pick"):
                    if spot != 0:
                        world.act("go", 0)
                    world.act("drop")
    return world.earned


def panel(count: int = 12) -> Bundle:
    """A switch changes its lamp and the next one; all lamps shall have colour 0, and looks are noisy."""
    writer = BundleWriter(
        f"panel{count}",
        _head(100, {"lamp": ("int", count, "0")})
        + f"""
initial_belief:
for (int i = 0; i < {count}; i++) state.lamp[i] = AOSUtils::SampleDiscrete(vector<double>({_COLOURS}, 1.0));

reward_code:
int right = 0;
for (int i = 0; i < {count}; i++) if (state.lamp[i] == 0) right++;
if (right == {count}) {{
    __isGoalState = true;
    __reward = 100;
}}
""",
    )
    one = {"which": str(count)}
    press = f"""__reward = -0.3;
state__.lamp[which] = (state.lamp[which] + 1) % {_COLOURS};
if (which + 1 < {count}) state__.lamp[which + 1] = (state.lamp[which + 1] + 1) % {_COLOURS};
__moduleResponse = pressed;"""
    writer.skill("press", ["pressed"], press, over=one)
    look = f"""__reward = -0.2;
int seen = state.lamp[which];
vector<double> others({_COLOURS - 1}, 1.0);
if (!AOS.Bernoulli({_TRUE})) seen = (seen + 1 + AOSUtils::SampleDiscrete(others)) % {_COLOURS};
__moduleResponse = seen == 0 ? white : seen == 1 ? red : seen == 2 ? green : blue;"""
    writer.skill("look", ["white", "red", "green", "blue"], look, over=one)
    return writer.files


class Panel(World):
    """The panel as the documents describe it."""

    discount = _DISCOUNT

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.lamps = [rng.randrange(_COLOURS) for _ in range(count)]

    def actions(self) -> list[tuple[str, int]]:
        return [(skill, i) for skill in ("press", "look") for i in range(len(self.lamps))]

    def act(self, skill: str, value: int = 0) -> str:
        if skill == "look":
            is_true = self.rng.random() < _TRUE
            self.gain(-0.2)
            return str((self.lamps[value] + (0 if is_true else self.rng.randrange(1, _COLOURS))) % _COLOURS)
        for lamp in range(value, min(value + 2, len(self.lamps))):
            self.lamps[lamp] = (self.lamps[lamp] + 1) % _COLOURS
        self.has_ended = not any(self.lamps)
        self.gain(99.7 if self.has_ended else -0.3)
        return ""


def panel_rule(count: int, rng: random.Random) -> float:
    """Looks at lamp after lamp until a colour has 0.95, and presses its switch until that is 0."""
    world = Panel(count, rng)
    while not world.is_over:
        for lamp in range(count):
            odds = np.full(_COLOURS, 1 / _COLOURS)
            while odds.max() < 0.95 and not world.is_over:
                seen = int(world.act("look", lamp))
                odds *= np.where(np.arange(_COLOURS) == seen, _TRUE, (1 - _TRUE) / (_COLOURS - 1))
                odds /= odds.sum()
            for _ in range(-int(odds.argmax()) % _COLOURS):
                if not world.is_over:
                    world.act("press", lamp)
    return world.earned


TOGETHER: dict[str, Callable[[int], Bundle]] = {"tidy": tidy, "panel": panel}
TOGETHER_SIZES = {"tidy": 6, "panel": 12}
TOGETHER_RULES: dict[str, Callable[[int, random.Random], float]] = {"tidy": tidy_rule, "panel": panel_rule}
TOGETHER_WORLDS: dict[str, Callable[[int, random.Random], World]] = {"tidy": Tidy, "panel": Panel}
