"""A solved policy as a file, and a mission that follows it.

A `.policy` file is a line of JSON (`PolicyHeader`), after it the alpha vectors (`alpha_vectors.py`), and at
its end the CRC-32 of all that is before.
"""

from __future__ import annotations

import time
import zlib
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path

import msgspec
import numpy as np
from msgspec.structs import replace

from aos_protocol.codec import UNREADABLE
from aos_protocol.errors import PlanningError
from aos_protocol.messages import ActionValue, ChosenBy, WeightedStates
from aos_solver.child.answers.models import Plan
from aos_solver.child.engine import Engine
from aos_solver.child.questions.missions import UNRESTRICTED, Restriction
from aos_solver.child.search import Search
from aos_solver.offline.alpha_vectors import AlphaVectors, Choice, RegionSize

FORMAT = "aos-policy-3"
_CHECKSUM_BYTES = 4


class PolicyHeader(msgspec.Struct, frozen=True, kw_only=True):
    """The subject of a policy.

    `model_digest` is the compiled model's, or the problem file's. `states` are the engine's texts of states,
    without what does not matter, or the problem file's names. From the start the policy gives at least
    `lower`, and no policy gives more than `upper`; both are discounted. With a `stop_value` the last action
    ends the mission, which is worth so much. `mission_parameters` are the values of all parts of mission
    parameters that it was solved with.
    """

    format: str = FORMAT
    model: str
    model_digest: str
    discount: float
    lower: float
    upper: float
    stop_value: float | None = None
    actions: tuple[str, ...]
    states: tuple[str, ...]
    regions: tuple[RegionSize, ...] = ()
    mission_parameters: dict[str, str] = {}


class Policy(msgspec.Struct, frozen=True, dict=True):
    """A policy by alpha vectors."""

    header: PolicyHeader
    vectors: AlphaVectors

    def save(self, path: Path) -> None:
        """Writes the file; PlanningError AOS321 if it cannot be."""
        header = replace(self.header, regions=self.vectors.sizes)
        try:
            data = msgspec.json.encode(header) + b"\n" + self.vectors.to_bytes()
            path.write_bytes(data + _checksum(data))
        except OSError as error:
            raise PlanningError(f"cannot write {path}: {error.strerror}", code="AOS321") from error

    @classmethod
    def load(cls, path: Path) -> Policy:
        """Reads a file; PlanningError AOS321 if it is none."""
        try:
            read = path.read_bytes()
            line, _, data = read[:-_CHECKSUM_BYTES].partition(b"\n")
            header = msgspec.json.decode(line, type=PolicyHeader)
            if header.format != FORMAT:
                raise ValueError(f"its format is {header.format}")
            if _checksum(read[:-_CHECKSUM_BYTES]) != read[-_CHECKSUM_BYTES:]:
                raise ValueError("it is damaged, for its checksum does not fit")
            return cls(header, AlphaVectors.of_bytes(len(header.actions), header.regions, data))
        except OSError as error:
            hint = "`aos solve TARGET --out FILE.policy` writes one"
            raise PlanningError(f"cannot read {path}: {error.strerror}", code="AOS321", hint=hint) from error
        except (*UNREADABLE, ValueError) as error:
            raise PlanningError(
                f"{path} is no policy of this version: {error}", code="AOS321", hint="Make it with aos solve"
            ) from error

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {text: number for number, text in enumerate(self.header.states)}

    def check_model(self, digest: str, mission_parameters: Mapping[str, str]) -> None:
        """Raises PlanningError AOS322 unless it was solved for the model with this digest and these
        values."""
        if digest != self.header.model_digest:
            message = f"the policy was solved for other documents of {self.header.model}"
            raise PlanningError(message, code="AOS322", hint="Solve it again with aos solve")
        solved = self.header.mission_parameters
        if solved != mission_parameters:
            names = [name for name in mission_parameters if solved.get(name) != mission_parameters[name]]
            raise PlanningError(
                f"the policy was solved for {_listed(solved, names)}, and this mission has "
                f"{_listed(mission_parameters, names)}",
                code="AOS322",
                hint=f"Solve it with aos solve {_options(mission_parameters, names)}",
            )

    def choose(self, belief: WeightedStates) -> Choice:
        """The choice at an engine's belief, exported without what does not matter.

        PlanningError AOS322 if no state of it is known.
        """
        weights = np.zeros(len(self.header.states))
        for weight, text in belief.particles:
            number = self._numbers.get(text)
            if number is not None:
                weights[number] += weight
        if not weights.any():
            message = "the policy knows no state of the belief in which the mission goes on"
            raise PlanningError(message, code="AOS322")
        return self.vectors.choose(weights)


def _checksum(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(_CHECKSUM_BYTES, "little")


class PolicySearch(Search, frozen=True, kw_only=True):
    """Decides by a policy instead of searching; the budget is not used."""

    policy: Policy

    @property
    def chosen_by(self) -> ChosenBy:
        """The policy, which searches nothing."""
        return "policy"

    def after_takeover(self) -> Search:
        """A search with the budget: the policy is for the model before."""
        fields = msgspec.structs.asdict(self)
        del fields["policy"]
        return Search(**fields)

    async def ponder(self, engine: Engine, step: int, index: int) -> None:
        """Nothing: a policy is ready made."""

    async def run(self, engine: Engine, step: int, within: Restriction = UNRESTRICTED) -> Plan:
        """The policy's action at the engine's belief; PlanningError AOS322 if the policy does not fit.

        Its values suppose that all skills can be used later, also those without which it decides now.

        Where the policy would stop it is the best of the other actions, whose value is then below that of
        stopping: whether the mission ends is for the mission's limits to say.
        """
        begun_s = time.perf_counter()
        self.policy.check_model(engine.model_digest, engine.description.mission_parameters)
        choice = self.policy.choose(await engine.export_belief(is_whole=False, cautious=within.cautious))
        names = [action.name for action in engine.description.actions]
        left_out = [
            n for n, action in enumerate(engine.description.actions) if action.skill in within.without
        ]
        values = choice.values[: len(names)].copy()
        values[[*within.barred, *left_out, *within.without_actions]] = -np.inf
        best = int(np.argmax(values))
        prediction = await engine.predict(best, cautious=within.cautious)
        actions = tuple(
            ActionValue(name, float(value), int(plans), 0.0)
            for name, value, plans in zip(names, choice.values, choice.plans, strict=False)
        )
        spent_s = time.perf_counter() - begun_s
        horizon = engine.description.horizon
        why = "a policy file was asked for"
        return Plan(best, 0, horizon, actions, prediction.predicted, spent_s, planner="policy", why=why)


def _listed(values: Mapping[str, str], names: Iterable[str]) -> str:
    return ", ".join(f"{name} = {values.get(name, 'nothing')}" for name in names)


def _options(values: Mapping[str, str], names: Iterable[str]) -> str:
    return " ".join(f"--set {name}={values[name]}" for name in names)


def following(search: Search, policy: Path | None, *, engine: Engine | None = None) -> Search:
    """The search itself, or one that follows the policy file where there is one.

    PlanningError where the file cannot be read, and where the policy is not for the model of this engine.
    """
    if policy is None:
        return search
    # Numbers take a tenth of a second to import, and few missions need them.
    from aos_solver.offline.policy import Policy, PolicySearch

    loaded = Policy.load(policy)
    if engine is not None:
        loaded.check_model(engine.model_digest, engine.description.mission_parameters)
    return PolicySearch(policy=loaded, **msgspec.structs.asdict(search))
