"""Gauges that are read by a camera, which dust blinds bit by bit, and which may break."""

import random

from .world import World
from .writing import Bundle, BundleWriter

_BAD, _DUST, _BREAKS, _SHARP, _BLUR = 0.3, 0.25, 0.02, 0.95, 0.13


def gauges(count: int = 8) -> Bundle:
    """Each gauge is to be reported as fine or bad; a plate at the base tells of the camera."""
    writer = BundleWriter(
        f"gauges{count}",
        f"""horizon: 50
discount: 0.98

state_variable: int at
default_value: {count}

state_variable: int dust

state_variable: bool is_broken

state_variable: bool is_bad []
code:
state.is_bad.assign({count}, false);

state_variable: bool is_told []
code:
state.is_told.assign({count}, false);

initial_belief:
for (int i = 0; i < {count}; i++) state.is_bad[i] = AOS.Bernoulli({_BAD});

extrinsic_code:
if (AOS.Bernoulli({_DUST})) state_.dust = std::min(state.dust + 1, 3);
if (AOS.Bernoulli({_BREAKS})) state_.is_broken = true;

reward_code:
bool is_over = true;
for (int i = 0; i < {count}; i++) if (!state.is_told[i]) is_over = false;
if (is_over) __isGoalState = true;
""",
    )
    sharp = f"double sharp = state.is_broken ? 0.5 : {_SHARP} - {_BLUR} * state.dust;\n"
    drive = "__reward = -0.4;\nstate__.at = place;\n__moduleResponse = there;"
    writer.skill("drive", drive, over={"place": str(count + 1)})
    read = f"""__reward = -0.2;
{sharp}bool is_bad = AOS.Bernoulli(sharp) == state.is_bad[std::min(state.at, {count - 1})];
__moduleResponse = state.at == {count} ? nothing : is_bad ? bad : fine;"""
    writer.skill("read", read)
    check = f"""__reward = -0.2;
{sharp}__moduleResponse = state.at == {count} && AOS.Bernoulli(sharp) ? clear : blurred;"""
    writer.skill("check", check)
    wipe = "__reward = -0.6;\nstate__.dust = 0;\n__moduleResponse = wiped;"
    writer.skill("wipe", wipe)
    swap = f"""__reward = -2;
if (state.at == {count}) {{ state__.dust = 0; state__.is_broken = false; }}
__moduleResponse = state.at == {count} ? swapped : refused;"""
    writer.skill("swap", swap)
    report = f"""int gauge = std::min(state.at, {count - 1});
bool can = state.at < {count} && !state.is_told[gauge];
__reward = !can ? -1 : state.is_bad[gauge] == (bad == 1) ? 3 : -5;
if (can) state__.is_told[gauge] = true;
__moduleResponse = told;"""
    writer.skill("report", report, over={"bad": "2"})
    return writer.files


class Gauges(World):
    """The camera and the gauges as the documents describe them."""

    def __init__(self, count: int, rng: random.Random):
        super().__init__(rng, 0.98, drive=count + 1, read=1, check=1, wipe=1, swap=1, report=2)
        self.bad = [rng.random() < _BAD for _ in range(count)]
        self.told = [False] * count
        self.at, self.dust, self.is_broken = count, 0, False

    def act(self, skill: str, value: int = 0) -> str:
        base, draw = len(self.bad), self.rng.random
        is_sharp = draw() < (0.5 if self.is_broken else _SHARP - _BLUR * self.dust)
        reward, answer = -0.4, ""
        if draw() < _DUST:
            self.dust = min(self.dust + 1, 3)
        self.is_broken |= draw() < _BREAKS
        if skill == "drive":
            self.at = value
        elif skill == "read":
            reward = -0.2
            if self.at != base:
                answer = "bad" if is_sharp == self.bad[self.at] else "fine"
        elif skill == "check":
            reward, answer = -0.2, "clear" if self.at == base and is_sharp else "blurred"
        elif skill == "wipe":
            reward, self.dust = -0.6, 0
        elif skill == "swap":
            reward = -2.0
            if self.at == base:
                self.dust, self.is_broken = 0, False
        elif self.at == base or self.told[self.at]:
            reward = -1.0
        else:
            reward, self.told[self.at] = (3.0 if self.bad[self.at] == (value == 1) else -5.0), True
            self.has_ended = all(self.told)
        self.gain(reward)
        return answer


def gauges_rule(count: int, rng: random.Random) -> float:
    """Wipes at each second gauge, reads until one answer leads by two; fetches a camera after seven reads."""
    world = Gauges(count, rng)
    for gauge in range(count):
        world.act("drive", gauge)
        if gauge % 2:
            world.act("wipe")
        lead, reads = 0, 0
        while abs(lead) < 2 and not world.is_over:
            lead += 1 if world.act("read") == "bad" else -1
            reads += 1
            if reads == 7:
                world.act("drive", count)
                world.act("swap")
                world.act("drive", gauge)
                lead = reads = 0
        if not world.is_over:
            world.act("report", int(lead > 0))
    return world.earned
