"""A project that changes all the time: skills, variables, rewards and endings, and mistakes."""

import random
from collections.abc import Callable

import msgspec
from mappings import mapping_text

PROJECT = "plug"

KINDS = (
    "added", "bettered", "removed", "variable added", "variable renamed", "variable retyped",
    "reward", "ending", "broken", "put back",
)  # fmt: skip


class Change(msgspec.Struct, frozen=True):
    """A push: `files` of documents, or a skill that is `removed`. Those that are broken are to be refused."""

    kind: str
    files: dict[str, bytes] = {}
    removed: str = ""


class _Facts(msgspec.Struct):
    """The parts of the project that change."""

    accuracy: float = 0.7
    reward: int = 1
    never: int = 1_000_000
    counter: str = "count"
    wet: str = "bool"
    extras: list[str] = []
    peeks: list[str] = []


class Project:
    """The documents as they are, and one change of them after the other."""

    def __init__(self, seed: int):
        self._chance = random.Random(seed)
        self._facts = _Facts()
        self._number = 0
        self._before: list[dict[str, bytes]] = []

    @property
    def files(self) -> dict[str, bytes]:
        facts = self._facts
        texts = {"plug.ef": _environment(facts), "listen.sd": _listen(facts), "wait.sd": _wait(facts)}
        texts["listen.am"] = mapping_text("left", "right", project=PROJECT, skill="listen")
        texts["wait.am"] = mapping_text("waited: True", project=PROJECT, skill="wait")
        for peek in facts.peeks:
            texts[f"{peek}.sd"] = _peek(facts)
            texts[f"{peek}.am"] = mapping_text("left", "right", project=PROJECT, skill=peek).replace(
                f"path: /{peek}", "path: /listen"
            )
        return {name: text.encode() for name, text in texts.items()}

    def change(self, kind: str) -> Change:
        self._number += 1
        changes: dict[str, Callable[[], Change]] = {
            "added": self._added,
            "removed": self._removed,
            "put back": self._put_back,
            "broken": self._broken,
        }
        return changes.get(kind, lambda: self._edited(kind))()

    def _edited(self, kind: str) -> Change:
        facts, chance = self._facts, self._chance
        before = self.files
        match kind:
            case "bettered":
                facts.accuracy = round(chance.uniform(0.55, 0.95), 6)
            case "variable added":
                facts.extras = [*facts.extras[-2:], f"extra{self._number}"]
            case "variable renamed":
                facts.counter = f"count{self._number}"
            case "variable retyped":
                facts.wet = "int" if facts.wet == "bool" else "bool"
                facts.reward = self._number
            case "reward":
                facts.reward = self._number
            case "ending":
                facts.never = 1_000_000 + self._number
        self._before.append(before)
        return Change(kind, self.files)

    def _added(self) -> Change:
        self._facts.peeks = [*self._facts.peeks[-1:], f"peek{self._number}"]
        return Change("added", self.files)

    def _removed(self) -> Change:
        if not self._facts.peeks:
            return self._added()
        return Change("removed", removed=self._facts.peeks.pop())

    def _put_back(self) -> Change:
        if not self._before:
            return self._edited("reward")
        return Change("put back", self._before[-1])

    def _broken(self) -> Change:
        files = self.files
        files["listen.sd"] = files["listen.sd"].replace(b"state.tiger ==", b"state.tigger ==")
        return Change("broken", files)


def _environment(facts: _Facts) -> str:
    extras = "".join(f"state_variable: bool {name}\n" for name in facts.extras)
    drawn = "".join(f"state.{name} = AOS.Bernoulli(0.5);\n" for name in facts.extras)
    return f"""project: {PROJECT}
horizon: 3
discount: 0.95
define_type: Side
enum_members: Left, Right
state_variable: Side tiger
state_variable: int {facts.counter}
state_variable: {facts.wet} is_wet
{extras}
initial_belief:
state.tiger = AOS.Bernoulli(0.5) ? Left : Right;
{drawn}
extrinsic_code:
if (AOS.Bernoulli(0.05)) state_.is_wet = !state.is_wet;

reward_code:
if (state.is_wet) __reward = {facts.reward};

reward_code:
if (state.{facts.counter} > {facts.never}) {{ __reward = 1; __isGoalState = true; }}
"""


def _listen(facts: _Facts) -> str:
    return f"""project: {PROJECT}
dynamic_model:
bool is_right = AOS.Bernoulli({facts.accuracy!r});
__moduleResponse = (state.tiger == Left) == is_right ? left : right;
__reward = -0.1;
"""


def _peek(facts: _Facts) -> str:
    return _listen(facts).replace(repr(facts.accuracy), "0.8").replace("-0.1", "-0.2")


def _wait(facts: _Facts) -> str:
    return f"""project: {PROJECT}
dynamic_model:
if (state.{facts.counter} < 3) state__.{facts.counter} = state.{facts.counter} + 1;
__moduleResponse = waited;
"""
