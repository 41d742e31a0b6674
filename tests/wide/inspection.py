"""A robot inspects shelves by a scanner that reports numbers. Here are the documents and a rule by hand."""

import math
import random

from .writing import Bundle, BundleWriter

_PRIOR = 0.15
_STATION_M = 4.0


def _environment(shelves: int) -> str:
    return f"""horizon: 60
discount: 0.97

state_variable: float at_m
default_value: 0

state_variable: bool is_misplaced []
code:
state.is_misplaced.assign({shelves}, false);

state_variable: bool is_reported []
code:
state.is_reported.assign({shelves}, false);

initial_belief:
for (int i = 0; i < {shelves}; i++) state.is_misplaced[i] = AOS.Bernoulli({_PRIOR});
"""


def inspection(shelves: int = 16) -> Bundle:
    """A shelf stands at each metre; scans are sharper from nearby, and a report that is wrong costs."""
    writer = BundleWriter(f"inspection{shelves}", _environment(shelves))
    drive = f"""__reward = -0.2 - 0.1 * fabs(state.at_m - {_STATION_M} * station);
state__.at_m = {_STATION_M} * station + AOS.SampleNormal(0, 0.3);
__moduleResponse = arrived;"""
    stations = math.ceil(shelves / _STATION_M)
    writer.skill("drive", ["arrived"], drive, over={"station": str(stations)})
    scan = """__reward = -0.2;
double deviation = 0.25 + 0.15 * fabs(state.at_m - shelf);
__moduleResponse = scanned;
__observed.likeness = AOS.SampleNormal(state.is_misplaced[shelf] ? 0.0 : 1.0, deviation);"""
    writer.skill("scan", ["scanned"], scan, over={"shelf": str(shelves)}, numbers=["likeness"])
    report = """if (state.is_reported[shelf]) {
    __reward = -1;
} else {
    __reward = state.is_misplaced[shelf] ? 8 : -8;
    state__.is_reported[shelf] = true;
}
__moduleResponse = noted;"""
    writer.skill("report", ["noted"], report, over={"shelf": str(shelves)})
    writer.skill("wait", ["waited"], "__moduleResponse = waited;")
    return writer.files


def inspection_rule(shelves: int, rng: random.Random) -> float:
    """Goes from station to station, scans each shelf around until it is clear, and reports it at 9 in 10."""
    wrong = [rng.random() < _PRIOR for _ in range(shelves)]
    at_m, earned, discount, steps = 0.0, 0.0, 1.0, 0

    def gain(reward: float) -> None:
        nonlocal earned, discount, steps
        earned, discount, steps = earned + discount * reward, discount * 0.97, steps + 1

    for station in range(math.ceil(shelves / _STATION_M)):
        if station:
            gain(-0.2 - 0.1 * abs(at_m - _STATION_M * station))
            at_m = _STATION_M * station + rng.gauss(0, 0.3)
        for shelf in range(shelves):
            if not -_STATION_M / 2 <= shelf - _STATION_M * station < _STATION_M / 2:
                continue
            odds = _PRIOR / (1 - _PRIOR)
            while 0.02 < odds < 9 and steps < 120:
                deviation = 0.25 + 0.15 * abs(at_m - shelf)
                seen = rng.gauss(0.0 if wrong[shelf] else 1.0, deviation)
                odds *= math.exp(((seen - 1) ** 2 - seen**2) / (2 * deviation**2))
                gain(-0.2)
            if odds >= 9 and steps < 120:
                gain(8.0 if wrong[shelf] else -8.0)
    return earned
