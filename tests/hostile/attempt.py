"""Attempts: documents with hostile code in `aos lint`, in missions and in pushes, and what came of them.

A round is every case in every way. A model or a compile attack has a command of its own, and a mission of its
own, which it ends. Mappings are attacks in one mission, which goes on and runs one after the other, and are
linted together: linting runs no mapping. One more mission receives every case as a push, in an order that is
another one in each round.
"""

import os
import random
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from tests.hostile.cases import COMPILED, MAPPINGS, MODELS
from tests.hostile.documents import (
    DEPLOY_FILE,
    HOSTILE,
    hostile_skills,
    place_of,
    write_hostile,
    write_system,
)
from tests.hostile.said import DID_NOT_END, Command, processor_s
from tests.hostile.secret import Secret
from tests.kept_cache import link_engines

WAYS = ("lint", "mission", "push")
TOLD_S = 15.0
"""The time within which a place is to be told on a machine that does nothing else."""
_HEARD_S = 8 * TOLD_S
_START_S = 240.0
_CASES = {"model": MODELS, "compiler": COMPILED, "mapping": MAPPINGS}
_HARMLESS = ("prints 1 GB",)
"""This is no fault: what is printed beyond the limit is dropped."""
_STEP = "step "
"""The words of a mission that goes on."""

Wanted = Callable[[str, str, str], bool]
"""Says whether an attempt of this kind, name and way is to be played."""


class Attempt(NamedTuple):
    """A case, played in one of the ways. `faults` are the promises that did not hold."""

    kind: str
    name: str
    way: str
    told_s: float | None
    processor_s: float
    faults: tuple[str, ...]


class Playground:
    """A folder with a secret, a cache of compiled models and the documents of one attempt after the other.

    What attacks at run time is compiled in the first round, and found in the cache in later ones: the file
    with the secret stays, and its content is another one in each attempt. `fresh` begins each attempt with
    an empty cache but for the engine, and starts commands as programs of their own.
    """

    def __init__(self, folder: Path, engines: Path, *, fresh: bool = False):
        self.folder = folder
        self._fresh = fresh
        self._engines = engines
        self._cache = folder / "cache"
        self._secret = Secret(folder / "home")
        self._said = folder / "said"
        self._said.mkdir()
        (folder / "tmp").mkdir()
        self._empty_cache()

    def round(self, order: str, wanted: Wanted) -> Iterator[Attempt]:
        """Plays the wanted attempts of a round; `order` decides about that of the pushes. Every process that
        an attempt started must have ended with it."""
        yield from self._lints(wanted)
        yield from self._missions(wanted)
        yield from self._pushes(wanted, random.Random(order))

    def _lints(self, wanted: Wanted) -> Iterator[Attempt]:
        for kind, name in _named("model", "compiler"):
            if wanted(kind, name, "lint"):
                bundle = self._written(kind, {HOSTILE: name})
                yield self._alone(kind, name, "lint", ["aos", "lint", str(bundle)])
        if names := [name for name in MAPPINGS if wanted("mapping", name, "lint")]:
            bundle = self._written("mapping", _skills(names))
            before_s = processor_s()
            lint = self._start(["aos", "lint", str(bundle)], "lint")
            faults = tuple(self._broken(lint.end(_HEARD_S)))
            spent_s = (processor_s() - before_s) / len(names)
            for name in names:
                yield Attempt("mapping", name, "lint", None, spent_s, faults)

    def _missions(self, wanted: Wanted) -> Iterator[Attempt]:
        for kind, name in _named("model", "compiler"):
            if wanted(kind, name, "mission"):
                self._written(kind, {HOSTILE: name})
                yield self._alone(kind, name, "mission", ["aos-up", DEPLOY_FILE, "--plain"])
        if names := [name for name in MAPPINGS if wanted("mapping", name, "mission")]:
            yield from self._mission_of_mappings(names)

    def _alone(self, kind: str, name: str, way: str, words: list[str]) -> Attempt:
        started_s, before_s = time.monotonic(), processor_s()
        command = self._start(words, way)
        is_harmless = way == "mission" and name in _HARMLESS
        words, heard_s = (_STEP, TOLD_S) if is_harmless else (place_of(kind, HOSTILE), _HEARD_S)
        told_s = command.listen(words, heard_s)
        # The lint of what nobody is told of ends by itself.
        said = command.end(_HEARD_S if way == "lint" else 0.0)
        faults = [*self._broken(said), *_untold(name, told_s, command)]
        spent_s = processor_s() - before_s
        told_s = None if told_s is None or is_harmless else told_s - started_s
        return Attempt(kind, name, way, told_s, spent_s, tuple(faults))

    def _mission_of_mappings(self, names: list[str]) -> Iterator[Attempt]:
        """One mission whose skills are all hostile but one; each is told once it has been run."""
        skills = _skills(names)
        self._written("mapping", skills, times=1)
        before_s = processor_s()
        mission = self._start(["aos-up", DEPLOY_FILE, "--plain"], "mission")
        mission.listen("mission", _START_S)
        places = {place_of("mapping", skill): name for skill, name in skills.items()}
        told = {places[words]: told_s for words, told_s in mission.listen_to_all(places, _HEARD_S)}
        faults = tuple(self._broken(mission.end()))
        spent_s = (processor_s() - before_s) / len(names)
        for name in names:
            own = tuple(_untold(name, told.get(name), mission))
            yield Attempt("mapping", name, "mission", told.get(name), spent_s, (*faults, *own))

    def _pushes(self, wanted: Wanted, chance: random.Random) -> Iterator[Attempt]:
        cases = [case for case in _named(*_CASES) if wanted(*case, "push")]
        chance.shuffle(cases)
        if not cases:
            return
        place = self.folder / "documents"
        write_system(place)
        before_s = processor_s()
        mission = self._start(["aos-up", DEPLOY_FILE, "--plain"], "mission")
        mission.listen(_STEP, _START_S)
        played = [self._push(mission, place, *case, deeper=number) for number, case in enumerate(cases)]
        goes_on = mission.listen(_STEP, _HEARD_S, after=mission.said_bytes) is not None
        faults = tuple(self._broken(mission.end()))
        # What the system itself spends is known when it has ended.
        rest_s = (processor_s() - before_s - sum(attempt.processor_s for attempt in played)) / len(played)
        if not goes_on:
            faults = (*faults, f"the mission did not go on: {mission.said[-400:]!r}")
        for number, attempt in enumerate(played):
            is_last = number == len(played) - 1
            own = attempt.faults + faults if is_last else attempt.faults
            yield attempt._replace(processor_s=attempt.processor_s + rest_s, faults=own)

    def _push(self, mission: Command, place: Path, kind: str, name: str, *, deeper: int) -> Attempt:
        bundle = place / "hostile"
        self._secret.renew()
        if self._fresh:
            self._empty_cache()
        write_hostile(bundle, kind, {HOSTILE: self._code(kind, name)}, deeper=deeper)
        running = str(place / "runs" / "latest")
        words = place_of(kind, HOSTILE, deeper=deeper)
        after, started_s, before_s = mission.said_bytes, time.monotonic(), processor_s()
        push = self._start(["aos", "bundle", "push", str(bundle), "--run", running], "push")
        told_s = push.listen(words, _HEARD_S)
        said = push.end(_HEARD_S)
        if told_s is None and name not in _HARMLESS:
            told_s = mission.listen(words, _HEARD_S, after=after)
        if kind == "mapping" or told_s is None:
            said += self._start(["aos", "bundle", "rm", "cell", HOSTILE, "--run", running], "removal").end(
                _HEARD_S
            )
        faults = [
            *self._broken(said + mission.said[after:], but=(mission.pid,)),
            *_untold(name, told_s, push),
        ]
        return Attempt(
            kind, name, "push", told_s and told_s - started_s, processor_s() - before_s, tuple(faults)
        )

    def _written(self, kind: str, skills: dict[str, str], *, times: int = 1) -> Path:
        """Writes the documents of an attempt, whose hostile skills have the names of cases; the bundle."""
        self._secret.renew()
        if self._fresh:
            self._empty_cache()
        bundle = write_system(self.folder / "documents", times=times)
        write_hostile(bundle, kind, {skill: self._code(kind, name) for skill, name in skills.items()})
        return bundle

    def _code(self, kind: str, name: str) -> str:
        secret = self._secret.file
        return _CASES[kind][name].replace("SECRET", str(secret)).replace("FOLDER", str(secret.parent))

    def _start(self, words: list[str], what: str) -> Command:
        environment = {
            **os.environ,
            "AOS_CACHE_DIR": str(self._cache),
            "AOS_RUNNING_DIR": str(self.folder / "running"),
            "AOS_CANARY": self._secret.canary,
            "TMPDIR": str(self.folder / "tmp"),
        }
        place = self.folder / "documents"
        return Command(words, place, environment, self._said / what, fresh=self._fresh)

    def _empty_cache(self):
        for entry in self._cache.glob("model-*"):
            entry.rename(self.folder / "tmp" / f"{entry.name}.{time.monotonic_ns()}")
        link_engines(self._engines, self._cache)

    def _broken(self, said: str, but: tuple[int, ...] = ()) -> Iterator[str]:
        if DID_NOT_END in said:
            yield "the command did not end when it was told to"
        yield from self._secret.broken(said, self.folder)
        if left := _left_running(but):
            yield f"{len(left)} processes run on: {'; '.join(left)}"


def _named(*kinds: str) -> list[tuple[str, str]]:
    return [(kind, name) for kind in kinds for name in _CASES[kind]]


def _skills(names: list[str]) -> dict[str, str]:
    return {skill: name for skill, name in hostile_skills().items() if name in names}


def _untold(name: str, told_s: float | None, command: Command) -> Iterator[str]:
    if told_s is None and name not in _HARMLESS:
        yield f"the line was not told: {command.said[-400:]!r}"


def _left_running(but: tuple[int, ...]) -> list[str]:
    """The command lines of what has become a child of this process, which adopts what others leave behind."""
    listing = Path(f"/proc/self/task/{os.getpid()}/children").read_text()
    left = []
    for pid in {int(text) for text in listing.split()} - {*but}:
        if os.waitpid(pid, os.WNOHANG)[0] == 0:
            command = Path(f"/proc/{pid}/cmdline").read_bytes()
            left.append(command.replace(b"\0", b" ").decode(errors="replace")[:200])
    return left
