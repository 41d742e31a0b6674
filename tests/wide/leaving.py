"""Problems where to leave at once returns nearly 0, and to look around costs.

Values of seen states promise much in all of them.
"""

import random
from collections.abc import Callable

import numpy as np

from .world import World
from .writing import Bundle, BundleWriter

__all__ = ["LEAVING", "LEAVING_RULES", "LEAVING_SIZES", "LEAVING_WORLDS"]

_DISCOUNT = 0.98

# --- a drone takes a photo and flies home ----------------------------------------------------------------

_BATTERY = 50
_BLOWN = 0.15
_SEEN = ((0.85, 0.1, 0.05), (0.1, 0.75, 0.15), (0.02, 0.05, 0.93))  # below, near, nothing: by the distance


def photo(size: int = 10) -> Bundle:
    """A drone finds a thing in one of many cells, in an east wind, and has to land at home in time."""
    writer = BundleWriter(
        f"photo{size}",
        f"""horizon: 55
discount: {_DISCOUNT}

state_variable: int x

state_variable: int y

state_variable: int thing

state_variable: int battery
default_value: {_BATTERY}

state_variable: bool has_photo

state_variable: bool has_landed

initial_belief:
state.thing = AOSUtils::SampleDiscrete(vector<double>({size * size}, 1.0));

extrinsic_code:
state_.battery = state.battery - 1;

reward_code:
if (state.has_landed) __isGoalState = true;
if (state.battery < 0) {{
    __isFailureState = true;
    __reward = -40;
}}
""",
    )
    fly = f"""__reward = -0.2;
bool is_blown = AOS.Bernoulli({_BLOWN});
int to_x = state_.x + (direction == 1) - (direction == 3) + (is_blown ? 1 : 0);
int to_y = state_.y + (direction == 2) - (direction == 0);
state__.x = std::max(0, std::min(to_x, {size - 1}));
state__.y = std::max(0, std::min(to_y, {size - 1}));
__moduleResponse = is_blown ? blown : moved;"""
    writer.skill("fly", ["moved", "blown"], fly, over={"direction": "4"})
    rows = ", ".join("{" + ", ".join(map(str, row)) + "}" for row in _SEEN)
    look = f"""__reward = -0.2;
static const vector<vector<double>> odds{{{rows}}};
int far = std::max(abs(state_.x - state_.thing % {size}), abs(state_.y - state_.thing / {size}));
int seen = AOSUtils::SampleDiscrete(odds[std::min(far, 2)]);
__moduleResponse = seen == 0 ? below : seen == 1 ? near_by : nothing;"""
    writer.skill("look", ["below", "near_by", "nothing"], look)
    take = f"""bool is_it = !state_.has_photo && state_.thing == state_.x + {size} * state_.y;
__reward = is_it ? 30 : -2;
if (is_it) state__.has_photo = true;
__moduleResponse = is_it ? taken : missed;"""
    writer.skill("take", ["taken", "missed"], take)
    land = """bool is_home = state_.x == 0 && state_.y == 0;
__reward = !is_home ? -20 : state_.has_photo ? 20 : 0;
state__.has_landed = true;
__moduleResponse = landed;"""
    writer.skill("land", ["landed"], land)
    return writer.files


class Photo(World):
    """The cells as the documents describe them."""

    discount = _DISCOUNT

    def __init__(self, size: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.size, self.thing = size, rng.randrange(size * size)
        self.x, self.y, self.battery, self.has_photo = 0, 0, _BATTERY, False

    def actions(self) -> list[tuple[str, int]]:
        return [*(("fly", direction) for direction in range(4)), ("look", 0), ("take", 0), ("land", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        self.battery -= 1
        told, reward = "", -0.2
        if skill == "fly":
            told = "blown" if self.rng.random() < _BLOWN else "moved"
            to_x = self.x + (value == 1) - (value == 3) + (told == "blown")
            self.x = max(0, min(to_x, self.size - 1))
            self.y = max(0, min(self.y + (value == 2) - (value == 0), self.size - 1))
        elif skill == "look":
            far = max(abs(self.x - self.thing % self.size), abs(self.y - self.thing // self.size))
            told = self.rng.choices(("below", "near_by", "nothing"), _SEEN[min(far, 2)])[0]
        elif skill == "take":
            is_it = not self.has_photo and self.thing == self.x + self.size * self.y
            told, reward = ("taken", 30) if is_it else ("missed", -2)
            self.has_photo |= is_it
        else:
            reward = -20 if self.x or self.y else 20 if self.has_photo else 0
            self.has_ended = True
        if self.battery < 0:
            self.has_ended, reward = True, reward - 40
        self.gain(reward)
        return told


def photo_rule(size: int, rng: random.Random) -> float:
    """Looks where most of the belief is near, takes a photo at 0.5, and flies home in time."""
    world = Photo(size, rng)
    xs, ys = np.arange(size * size) % size, np.arange(size * size) // size
    odds = np.full(size * size, 1 / size**2)
    looks = dict.fromkeys(range(size * size), 0)
    while not world.is_over:
        here = world.x + size * world.y
        home = world.x + world.y
        if world.has_photo or world.battery <= 1.35 * world.x + world.y + 5:
            world.act(*(("land", 0) if home == 0 else ("fly", 3) if world.x else ("fly", 0)))
            continue
        far = np.maximum(abs(xs - world.x), abs(ys - world.y))
        if odds[here] > 0.5:
            if world.act("take") == "missed":
                odds[here] = 0
        elif odds[far <= 1].sum() > 0.04 and looks[here] < 3:
            told = ("below", "near_by", "nothing").index(world.act("look"))
            odds *= np.array([_SEEN[min(distance, 2)][told] for distance in far])
            looks[here] += 1
        else:
            near = [odds[(abs(xs - x) <= 1) & (abs(ys - y) <= 1)].sum() for x, y in zip(xs, ys, strict=True)]
            worth = (np.array(near) + 2 * odds) / (3 + abs(xs - world.x) + abs(ys - world.y))
            worth[here] = 0
            goal = int(worth.argmax())
            east, south = int(xs[goal]) - world.x, int(ys[goal]) - world.y
            direction = (2 if south > 0 else 0) if abs(south) >= abs(east) else 1 if east > 0 else 3
            world.act("fly", direction)
        odds = odds / odds.sum()
    return world.earned


# --- a rover at sites that are hardly worth a probe ------------------------------------------------------

_GOOD, _TELLS = 0.3, 0.7


def survey(sites: int = 12) -> Bundle:
    """Few sites are good, probes tell little, and to leave ends it: that is nearly as good as anything."""
    writer = BundleWriter(
        f"survey{sites}",
        f"""horizon: 40
discount: {_DISCOUNT}

state_variable: int at

state_variable: bool has_left

state_variable: bool is_good []
code:
state.is_good.assign({sites}, false);

state_variable: bool is_taken []
code:
state.is_taken.assign({sites}, false);

initial_belief:
for (int i = 0; i < {sites}; i++) state.is_good[i] = AOS.Bernoulli({_GOOD});

reward_code:
if (state.has_left) __isGoalState = true;
""",
    )
    drive = f"""__reward = -0.5;
state__.at = std::max(0, std::min(state.at + (east == 1 ? 1 : -1), {sites - 1}));
__moduleResponse = there;"""
    writer.skill("drive", ["there"], drive, over={"east": "2"})
    probe = f"""__reward = -0.5;
__moduleResponse = AOS.Bernoulli({_TELLS}) == state.is_good[state.at] ? good : bad;"""
    writer.skill("probe", ["good", "bad"], probe)
    dig = """__reward = state.is_taken[state.at] ? -4 : state.is_good[state.at] ? 3 : -5;
state__.is_taken[state.at] = true;
__moduleResponse = dug;"""
    writer.skill("dig", ["dug"], dig)
    leave = """state__.has_left = true;
__moduleResponse = left;"""
    writer.skill("leave", ["left"], leave)
    return writer.files


class Survey(World):
    """The sites as the documents describe them."""

    discount = _DISCOUNT

    def __init__(self, sites: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.good = [rng.random() < _GOOD for _ in range(sites)]
        self.taken = [False] * sites
        self.at = 0

    def actions(self) -> list[tuple[str, int]]:
        return [("drive", 0), ("drive", 1), ("probe", 0), ("dig", 0), ("leave", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        told, reward = "", -0.5
        if skill == "drive":
            self.at = max(0, min(self.at + (1 if value else -1), len(self.good) - 1))
        elif skill == "probe":
            told = "good" if (self.rng.random() < _TELLS) == self.good[self.at] else "bad"
        elif skill == "dig":
            reward = -4 if self.taken[self.at] else 3 if self.good[self.at] else -5
            self.taken[self.at] = True
        else:
            reward, self.has_ended = 0, True
        self.gain(reward)
        return told


def survey_rule(sites: int, rng: random.Random) -> float:
    """Leaves at once."""
    world = Survey(sites, rng)
    world.act("leave")
    return world.earned


# --- prospects with grades that are numbers --------------------------------------------------------------

_MEAN, _SPREAD, _NOISE = -3.0, 4.0, 3.0


def prospects(count: int = 8) -> Bundle:
    """Grades are continuous, assays noisy; one site is opened, which ends it, or none."""
    writer = BundleWriter(
        f"prospects{count}",
        f"""horizon: 30
discount: {_DISCOUNT}

state_variable: bool is_over

state_variable: double grade []
code:
state.grade.assign({count}, 0.0);

initial_belief:
for (int i = 0; i < {count}; i++) state.grade[i] = AOS.SampleNormal({_MEAN}, {_SPREAD});

reward_code:
if (state.is_over) __isGoalState = true;
""",
    )
    assay = f"""__reward = -0.2;
__moduleResponse = assayed;
__observed.grade = AOS.SampleNormal(state.grade[site], {_NOISE});"""
    writer.skill("assay", ["assayed"], assay, over={"site": str(count)}, numbers=["grade"])
    start = """__reward = state.grade[site];
state__.is_over = true;
__moduleResponse = opened;"""
    writer.skill("open_site", ["opened"], start, over={"site": str(count)})
    writer.skill("leave", ["left"], "state__.is_over = true;\n__moduleResponse = left;")
    return writer.files


class Prospects(World):
    """The sites as the documents describe them."""

    discount = _DISCOUNT

    def __init__(self, count: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.grades = [rng.gauss(_MEAN, _SPREAD) for _ in range(count)]
        self.told = 0.0

    def actions(self) -> list[tuple[str, int]]:
        sites = range(len(self.grades))
        return [*(("assay", site) for site in sites), *(("open_site", site) for site in sites), ("leave", 0)]

    def act(self, skill: str, value: int = 0) -> str:
        reward = -0.2
        if skill == "assay":
            self.told = self.rng.gauss(self.grades[value], _NOISE)
        else:
            reward = self.grades[value] if skill == "open_site" else 0.0
            self.has_ended = True
        self.gain(reward)
        return ""


def prospects_rule(count: int, rng: random.Random) -> float:
    """Assays what has the highest mean and a deviation until one is above 1.5 or none can be above 0."""
    world = Prospects(count, rng)
    means, precisions = np.full(count, _MEAN), np.full(count, _SPREAD**-2)
    while not world.is_over:
        best = int(means.argmax())
        hopes = means + precisions**-0.5
        if means[best] > 1.5:
            world.act("open_site", best)
        elif hopes.max() < 0.5 or world.steps > 25:
            world.act("leave")
        else:
            site = int(hopes.argmax())
            world.act("assay", site)
            total = precisions[site] + _NOISE**-2
            means[site] = (means[site] * precisions[site] + world.told * _NOISE**-2) / total
            precisions[site] = total
    return world.earned


# --- questions that tell nothing alone -------------------------------------------------------------------

_NUMBERS, _LAMPS, _RIGHT = 64, 18, 0.9


def questions(lamps: int = _LAMPS) -> Bundle:
    """A number is guessed after questions, none of which is worth its cost alone. Lamps make states many."""
    writer = BundleWriter(
        f"questions{lamps}",
        f"""horizon: 30
discount: {_DISCOUNT}

state_variable: bool is_over

state_variable: int number

state_variable: bool is_lit []
code:
state.is_lit.assign({lamps}, false);

initial_belief:
state.number = AOSUtils::SampleDiscrete(vector<double>({_NUMBERS}, 1.0));
for (int i = 0; i < {lamps}; i++) state.is_lit[i] = AOS.Bernoulli(0.5);

reward_code:
if (state.is_over) __isGoalState = true;
""",
    )
    ask = f"""__reward = -0.3;
__moduleResponse = AOS.Bernoulli({_RIGHT}) == (state.number > limit) ? above : below;"""
    writer.skill("ask", ["above", "below"], ask, over={"limit": str(_NUMBERS - 1)})
    see = "__reward = -0.3;\n__moduleResponse = state.is_lit[lamp] ? lit : dark;"
    writer.skill("see", ["lit", "dark"], see, over={"lamp": str(lamps)})
    guess = """__reward = state.number == number ? 15 : -10;
state__.is_over = true;
__moduleResponse = guessed;"""
    writer.skill("guess", ["guessed"], guess, over={"number": str(_NUMBERS)})
    writer.skill("leave", ["left"], "state__.is_over = true;\n__moduleResponse = left;")
    return writer.files


class Questions(World):
    """The number as the documents describe it."""

    discount = _DISCOUNT

    def __init__(self, lamps: int, rng: random.Random) -> None:
        super().__init__(rng)
        self.number, self.lamps = rng.randrange(_NUMBERS), lamps

    def actions(self) -> list[tuple[str, int]]:
        counts = {"ask": _NUMBERS - 1, "see": self.lamps, "guess": _NUMBERS, "leave": 1}
        return [(skill, value) for skill, count in counts.items() for value in range(count)]

    def act(self, skill: str, value: int = 0) -> str:
        reward = -0.3 if skill in {"ask", "see"} else 0.0
        if skill == "guess":
            reward = 15.0 if value == self.number else -10.0
        self.has_ended = skill in {"guess", "leave"}
        self.gain(reward)
        return "above" if (self.rng.random() < _RIGHT) == (self.number > value) else "below"


def questions_rule(lamps: int, rng: random.Random) -> float:
    """Asks for the half of the belief, and guesses at 0.8."""
    world = Questions(lamps, rng)
    odds = np.full(_NUMBERS, 1 / _NUMBERS)
    while not world.is_over:
        if odds.max() > 0.8:
            world.act("guess", int(odds.argmax()))
            continue
        limit = int(abs(odds.cumsum() - 0.5)[:-1].argmin())
        is_above = world.act("ask", limit) == "above"
        odds *= np.where((np.arange(_NUMBERS) > limit) == is_above, _RIGHT, 1 - _RIGHT)
        odds /= odds.sum()
    return world.earned


LEAVING: dict[str, Callable[[int], Bundle]] = {
    "photo": photo,
    "survey": survey,
    "prospects": prospects,
    "questions": questions,
}
LEAVING_SIZES = {"photo": 10, "survey": 12, "prospects": 8, "questions": _LAMPS}
LEAVING_RULES = {
    "photo": photo_rule,
    "survey": survey_rule,
    "prospects": prospects_rule,
    "questions": questions_rule,
}
LEAVING_WORLDS: dict[str, type[Photo] | type[Survey] | type[Prospects] | type[Questions]] = {
    "photo": Photo,
    "survey": Survey,
    "prospects": Prospects,
    "questions": Questions,
}
