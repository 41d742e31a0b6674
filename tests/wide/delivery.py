"""A robot that brings parcels to rooms on two floors: its documents, and a rule by hand."""

import random

import numpy as np

from .writing import Bundle, BundleWriter

_ROOMS = 8  # the parcels wait in room 0; rooms 4 to 7 are upstairs
_BATTERY = 14
_BREAKS, _MENDED = 0.05, 0.3
_TRUE = 0.8  # of the answers about a parcel
_HORIZON, _DISCOUNT = 80, 0.98


def _environment(parcels: int) -> str:
    return f"""horizon: {_HORIZON}
discount: {_DISCOUNT}

state_variable: int at

state_variable: int battery
default_value: {_BATTERY}

state_variable: bool lift_is_broken

state_variable: int receiver []
code:
state.receiver.assign({parcels}, 0);

state_variable: bool held []
code:
state.held.assign({parcels}, false);

state_variable: bool brought []
code:
state.brought.assign({parcels}, false);

initial_belief:
vector<double> free(7, 1.0);
for (int i = 0; i < {parcels}; i++) {{
    int room = AOSUtils::SampleDiscrete(free);
    free[room] = 0;
    state.receiver[i] = room + 1;
}}

extrinsic_code:
bool changes = AOS.Bernoulli(state.lift_is_broken ? {_MENDED} : {_BREAKS});
if (changes) state_.lift_is_broken = !state.lift_is_broken;

reward_code:
if (state.battery < 0) {{
    __isFailureState = true;
    __reward = -40;
}}

reward_code:
bool all = true;
for (int i = 0; i < {parcels}; i++) if (!state.brought[i]) all = false;
if (all) {{
    __isGoalState = true;
    __reward = 20;
}}
"""


def delivery(parcels: int = 6) -> Bundle:
    """Parcels with unknown receivers, who differ; a lift that breaks and is mended; a battery."""
    writer = BundleWriter(f"delivery{parcels}", _environment(parcels))
    ride = """bool takes_lift = to / 4 != state.at / 4;
state__.battery = state.battery - (takes_lift ? 2 : 1);
__reward = takes_lift ? -1 : -0.5;
if (takes_lift && state.lift_is_broken) {
    __moduleResponse = stuck;
} else {
    state__.at = to;
    __moduleResponse = arrived;
}"""
    writer.skill("ride", ["arrived", "stuck"], ride, over={"to": str(_ROOMS)})
    what = {"what": str(parcels)}
    take = f"""int carried = 0;
for (int i = 0; i < {parcels}; i++) carried += state.held[i];
if (state.at == 0 && carried < 2 && !state.held[what] && !state.brought[what]) {{
    state__.held[what] = true;
    __reward = -0.5;
    __moduleResponse = taken;
}} else {{
    __reward = -1;
    __moduleResponse = refused;
}}"""
    writer.skill("take", ["taken", "refused"], take, over=what)
    hand = """if (state.held[what] && state.receiver[what] == state.at) {
    state__.held[what] = false;
    state__.brought[what] = true;
    __reward = 10;
    __moduleResponse = thanks;
} else {
    __reward = -3;
    __moduleResponse = not_mine;
}"""
    writer.skill("hand", ["thanks", "not_mine"], hand, over=what)
    ask = f"""__reward = -0.3;
int told = state.receiver[what];
if (!AOS.Bernoulli({_TRUE})) told = 1 + (told + AOSUtils::SampleDiscrete(vector<double>(6, 1.0))) % 7;
__moduleResponse = told == 1 ? room1 : told == 2 ? room2 : told == 3 ? room3 : told == 4 ? room4
    : told == 5 ? room5 : told == 6 ? room6 : room7;"""
    writer.skill("ask", [f"room{room}" for room in range(1, _ROOMS)], ask, over=what)
    writer.charger(_BATTERY)
    return writer.files


class _Robot:
    """The world of the rule, and what it has earned in it."""

    def __init__(self, parcels: int, rng: random.Random) -> None:
        self._rng = rng
        self._receivers = [room + 1 for room in rng.sample(range(_ROOMS - 1), parcels)]
        self._lift_is_broken = False
        self.at, self.battery = 0, _BATTERY
        self.earned, self._discount, self.steps = 0.0, 1.0, 0

    def _pass(self, reward: float) -> None:
        if self.steps < _HORIZON:
            self.earned += self._discount * reward
        self._discount *= _DISCOUNT
        self.steps += 1
        odds = _MENDED if self._lift_is_broken else _BREAKS
        self._lift_is_broken = self._lift_is_broken != (self._rng.random() < odds)

    def ask(self, parcel: int) -> int:
        told = self._receivers[parcel]
        if self._rng.random() >= _TRUE:
            told = self._rng.choice([room for room in range(1, _ROOMS) if room != told])
        self._pass(-0.3)
        return told

    def ride(self, to: int) -> None:
        takes_lift = to // 4 != self.at // 4
        self.battery -= 2 if takes_lift else 1
        if not (takes_lift and self._lift_is_broken):
            self.at = to
        self._pass((-1 if takes_lift else -0.5) - (40 if self.battery < 0 else 0))

    def hand(self, parcel: int, is_last: bool) -> bool:
        is_right = self._receivers[parcel] == self.at
        self._pass((30 if is_last else 10) if is_right else -3)
        return is_right

    def wait(self, reward: float) -> None:
        self._pass(reward)


def delivery_rule(parcels: int, rng: random.Random) -> float:
    """Ask until one room has 0.85, take two, bring each where it most likely belongs, and charge between."""
    robot = _Robot(parcels, rng)
    odds = np.full((parcels, _ROOMS), 1 / (_ROOMS - 1))
    odds[:, 0] = 0
    left = list(range(parcels))
    while left and robot.battery >= 0 and robot.steps < _HORIZON:
        carried = left[:2]
        for parcel in carried:
            while odds[parcel].max() < 0.85:
                told = robot.ask(parcel)
                odds[parcel] *= np.where(np.arange(_ROOMS) == told, _TRUE, (1 - _TRUE) / (_ROOMS - 2))
                odds[parcel] /= odds[parcel].sum()
            robot.wait(-0.5)
        while carried and robot.battery >= 0:
            parcel = carried[0]
            room = int(odds[parcel].argmax())
            way_back = 4 if robot.at >= 4 or room >= 4 else 3
            if robot.battery < 3 + way_back and robot.at != 0:
                robot.ride(0)
                if robot.at == 0:
                    robot.battery = _BATTERY
                    robot.wait(-0.5)
            elif robot.at != room:
                robot.ride(room)
            elif robot.hand(parcel, len(left) == 1):
                left.remove(parcel)
                carried.remove(parcel)
                odds[left, room] = 0
                odds[left] /= odds[left].sum(axis=1, keepdims=True)
            else:
                odds[parcel, room] = 0
                odds[parcel] /= odds[parcel].sum()
        while left and robot.at != 0 and robot.battery >= 0:
            robot.ride(0)
        if left:
            robot.battery = _BATTERY
            robot.wait(-0.5)
    return robot.earned
