"""Tries the bus: the matrix of the table, forgeries in a mission and malformed messages.

python -m tests.hostile.bus                     all of it
python -m tests.hostile.bus matrix forgeries    parts
"""

import argparse
import math
import random
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from .cell import STEPS, cell
from .far import FarMission, far_mission, is_possible
from .forgeries import FORGERIES, faults_of
from .malformed import flooded_keys, flooding
from .matrix import PARTIES, attempts, wrong
from .routed import routed

MAY_ANSWER_S = 0.1
MAY_GROW_BYTES = 20_000_000
MAY_HOLD_S, MAY_GO_ON_S = 4.0, 5.0
LINKS = {
    "good": ("a good link", 0.0, 0.0),
    "delay": ("200 ms of delay", 0.2, 0.0),
    "loss": ("5 % of the packets lost", 0.0, 0.05),
}


def matrix(folder: Path, _: argparse.Namespace) -> int:
    """Every party, act and key."""
    tried = list(attempts())
    with routed(folder, PARTIES) as router:
        found = list(wrong(router, tried))
    allowed = sum(attempt.is_allowed for attempt in tried)
    print(f"matrix: {allowed} allowed and {len(tried) - allowed} denied attempts, {len(found)} otherwise")
    for line in found:
        print(f"  {line}")
    return len(found)


def forgeries(folder: Path, _: argparse.Namespace) -> int:
    """Made-up messages, while a mission waits for them; then it must end as if nothing had been."""
    broken = 0
    with cell(folder) as mission:
        for forgery in FORGERIES:
            faults = faults_of(mission, forgery)
            broken += bool(faults)
            print(f"  {forgery.name}: {'; '.join(faults) or forgery.gets}", flush=True)
        mission.go_on()
        is_unharmed = mission.exit_code == 0 and mission.moved == ["step"] * STEPS
    ending = mission.summary["ending"]
    motions = len(mission.moved)
    print(f"forgeries: {len(FORGERIES)}, {broken} broke a promise; mission: {ending}, {motions} motions")
    return broken + (not is_unharmed)


def malformed(folder: Path, options: argparse.Namespace) -> int:
    broken, slowest_s, most_bytes = 0, 0.0, 0
    with cell(folder) as mission:
        for key, user, is_question in flooded_keys():
            flood = flooding(mission, key, user, is_question, options.messages)
            grown_bytes = max(flood.grown_bytes.values())
            slowest_s, most_bytes = max(slowest_s, flood.slowest_s), max(most_bytes, grown_bytes)
            broken += flood.slowest_s > MAY_ANSWER_S or grown_bytes > MAY_GROW_BYTES
            print(
                f"  {key} by {user}: {flood.sent} in {flood.took_s:.1f} s, slowest answer "
                f"{flood.slowest_s * 1e3:.0f} ms, {flood.waited_s * 1e3:.0f} ms waited for a processor, "
                f"memory +{grown_bytes / 1e6:.1f} MB",
                flush=True,
            )
        mission.go_on()
    print(
        f"malformed: {broken} keys with an answer later than {MAY_ANSWER_S:g} s or more than "
        f"{MAY_GROW_BYTES / 1e6:g} MB; slowest {slowest_s * 1e3:.0f} ms, at most +{most_bytes / 1e6:.1f} MB; "
        f"mission: exit code {mission.exit_code}"
    )
    return broken + (mission.exit_code != 0)


def far(folder: Path, options: argparse.Namespace) -> int:
    """Bad links to adapters on another host, all at once: cuts, a delay, lost packets, cuts with these."""
    if not is_possible():
        print("far: needs ip, sshd, ssh and /dev/net/tun, and to be root")
        return 0
    with ThreadPoolExecutor() as threads:
        return sum(threads.map(partial(over_link, folder, options), options.links))


def over_link(folder: Path, options: argparse.Namespace, name: str) -> int:
    """A mission over one of the links: motions without a cut, then cuts."""
    words, delay_s, loss = LINKS[name]
    place = folder / name
    place.mkdir()
    with far_mission(place, list(LINKS).index(name)) as mission:
        mission.link.delay_s, mission.link.loss = delay_s, loss
        since_s = time.monotonic()
        has_moved = mission.until_moved(options.motions)
        took_s = (time.monotonic() - since_s) / max(options.motions, 1)
        held = mission.holds_since(since_s)
        print(f"{words}: {options.motions} motions, {took_s:.2f} s each, held {held} times", flush=True)
        broken = (not has_moved) + late_cuts(mission, options.cuts, words)
        if mission.has_ended:
            print((place / "aos-up.log").read_text())
            return broken + 1
        twice = len(mission.moved) - len(set(mission.moved))
    print(f"{words}: {options.cuts} cuts, {broken} late; {twice} motions twice", flush=True)
    return broken + twice


def late_cuts(mission: FarMission, cuts: int, link: str) -> int:
    """Cuts of 0.2 to 30 s; those after which the mission held too late, or went on too late."""
    chance, late = random.Random(1), 0
    for _ in range(cuts):
        since_s = time.monotonic()
        cut = mission.cut(math.exp(chance.uniform(math.log(0.2), math.log(30.0))))
        is_held_late = cut.cut_s > MAY_HOLD_S and (cut.held_s is None or cut.held_s > MAY_HOLD_S)
        is_late = is_held_late or cut.went_on_s is None or cut.went_on_s > MAY_GO_ON_S
        late += is_late
        held, went_on = ("-" if one is None else f"{one:.1f} s" for one in cut[1:])
        print(
            f"  {link}: cut for {cut.cut_s:.1f} s: held after {held}, went on {went_on} after its end",
            flush=True,
        )
        if is_late:
            print("    " + "; ".join(mission.told_since(since_s)), flush=True)
        if mission.has_ended:
            break
    return late


PARTS: dict[str, Callable[[Path, argparse.Namespace], int]] = {
    "matrix": matrix,
    "forgeries": forgeries,
    "malformed": malformed,
    "far": far,
}


def main() -> int:
    """Exit code 0 where every promise was kept."""
    parser = argparse.ArgumentParser(prog="python -m tests.hostile.bus", description=__doc__)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="of these alone")
    parser.add_argument("--messages", type=int, default=20_000, help="malformed messages on each key")
    parser.add_argument("--cuts", type=int, default=20, help="of each link to an adapter on another host")
    parser.add_argument("--motions", type=int, default=20, help="over each of these links without a cut")
    parser.add_argument("--links", nargs="+", choices=LINKS, default=list(LINKS), help="of these alone")
    options = parser.parse_args()
    broken = 0
    for part in options.parts or PARTS:
        with tempfile.TemporaryDirectory(prefix="aos-bus-", ignore_cleanup_errors=True) as folder:
            broken += PARTS[part](Path(folder), options)
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
