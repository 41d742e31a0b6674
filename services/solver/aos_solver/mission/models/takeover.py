"""The takeover of a mission by another model: how the model comes to its belief.

Where the layout of the state is the same, the belief is imported. Else the new model replays the mission's
past from its own initial belief. Where the past is impossible in it, or would take too long, the variables
that both models have keep their joint distribution, and the others are as the initial belief has them.

A mission that is taken up goes once more through the models that it had, one after the other.
"""

import asyncio
import re
from collections.abc import AsyncIterator, Callable, Collection, Mapping, Sequence
from typing import NamedTuple, Self

import msgspec

from aos_protocol.documents import Skill
from aos_protocol.errors import AosError, ModelError
from aos_protocol.messages import BeliefSummary, DriftTests, Marginal, ModelAdopted, TakeoverWay
from aos_runtime.clock import Clock, SystemClock
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.child.engine import Engine
from aos_solver.mission.models.past import Past, replayed
from aos_solver.mission.rules.drift import begun

REPLAY_S = 10.0
"""A replay that would take longer is given up."""

_TELLING_S = 1.0
"""The steps in so much time tell how long a replay takes. The first ones of an engine alone are slow."""

_UNNOTICED_S = 0.02
"""A decision may wait so long for the last steps of a replay."""

_ROUNDING = 1e-9

_VARIABLE = re.compile(r"\w+")


class RunningModel(msgspec.Struct, frozen=True):
    """A compiled model with its engine child, and the documents of its skills where they are known."""

    revision: int
    engine: Engine
    skills: tuple[Skill, ...] = ()

    @property
    def digest(self) -> str:
        return self.engine.model_digest

    def renewed_since(self, before: Self) -> list[str]:
        """Returns the skills whose documents are new, or others than those of the model before."""
        return [skill.name for skill in self.skills if skill not in before.skills]

    def drift_tests(self) -> DriftTests:
        """The tests of the model, as they begin. Skills that report any text have none."""
        texting = self.engine.texting_skills
        responses = self.engine.description.responses.items()
        return begun(self.digest, {skill: names for skill, names in responses if skill not in texting})


class Takeover(msgspec.Struct, frozen=True):
    """A model that has taken a mission over, its belief, and the journal's row of it."""

    model: RunningModel
    belief: BeliefSummary
    row: ModelAdopted


class Successor:
    """A model with an engine of its own that is to take a mission over, and how far its belief is."""

    def __init__(self, model: RunningModel, clock: Clock) -> None:
        self.model = model
        self._clock = clock
        self._past: Past | None = None
        self._done = 0
        self._foreign = 0
        self._spent_s = 0.0
        self._cannot_import = ""
        self._cannot_replay = ""
        self._replaying = asyncio.Lock()
        self._following: asyncio.Task[None] | None = None

    def is_ready(self, running: RunningModel, past: Past) -> bool:
        """Returns whether the model can take over now, without anybody waiting for it."""
        if self._imports_from(running):
            return True
        if past is not self._past:
            return not past.steps
        missing = len(past) - self._done
        return bool(self._cannot_replay) or missing <= 1 or missing * self._mean_s <= _UNNOTICED_S

    def follow(self, running: RunningModel, past: Past, on_ready: Callable[[], None]) -> None:
        """Replays the past beside the mission, as far as it has come, where the model needs that."""
        needs_that = not self._imports_from(running) and (past is not self._past or self._done < len(past))
        if needs_that and (self._following is None or self._following.done()):
            self._following = asyncio.create_task(self._replay(past))
            self._following.add_done_callback(lambda _: on_ready())

    async def take_over(self, running: RunningModel, past: Past) -> Takeover | None:
        """Gives the model its belief; None if another way has to be prepared first.

        ModelError AOS112 if there is no way.
        """
        if self._imports_from(running):
            await self.end_following()
            summary = await self._imported(running)
            return None if summary is None else self._takeover(running, past, summary, "import")
        engine = self.model.engine
        before = await running.engine.marginals()
        await self._replay(past)
        await self.end_following()
        if self._cannot_replay:
            summary = await self._projected(running)
        else:
            summary = await engine.summary()
        kept = running.engine.layout.common_with(engine.layout).kept
        return self._takeover(
            running,
            past,
            summary,
            "projection" if self._cannot_replay else "replay",
            distances(before, await engine.marginals(), kept),
        )

    async def close(self) -> None:
        """Ends the engine, and what it works on."""
        await self.end_following()
        await self.model.engine.close()

    async def end_following(self) -> None:
        """Ends the replay beside the mission."""
        following, self._following = self._following, None
        if following is not None:
            following.cancel()
            await asyncio.wait({following})

    def _imports_from(self, running: RunningModel) -> bool:
        return not self._cannot_import and self.model.engine.state_digest == running.engine.state_digest

    async def _imported(self, running: RunningModel) -> BeliefSummary | None:
        beliefs = await running.engine.export_beliefs()
        try:
            return await self.model.engine.import_beliefs(beliefs)
        except AosError as error:
            self._cannot_import = str(error)
            return None

    async def _replay(self, past: Past) -> None:
        async with self._replaying:
            is_another = past is not self._past
            if self._cannot_replay and not is_another:
                return
            try:
                async with asyncio.timeout(REPLAY_S if is_another else max(REPLAY_S - self._spent_s, 0.0)):
                    if is_another:
                        await self._begin(past)
                    await self._replay_the_rest(past)
            except TimeoutError:
                self._cannot_replay = f"the replay of {len(past)} steps takes longer than {REPLAY_S:g} s"
            except AosError as error:
                self._cannot_replay = f"step {self._done + 1} cannot be replayed: {error}"

    async def _begin(self, past: Past) -> None:
        """Goes back to the initial belief, for another past than before."""
        if self._past is not None:
            await self.model.engine.reset_belief()
        self._past, self._done, self._foreign, self._spent_s = past, 0, 0, 0.0
        self._cannot_replay = ""

    async def _replay_the_rest(self, past: Past) -> None:
        since_s = self._clock.monotonic_s()
        async for update in replayed(self.model.engine, past, self._done):
            now_s = self._clock.monotonic_s()
            self._spent_s, since_s = self._spent_s + now_s - since_s, now_s
            step = past.steps[self._done]
            self._done += 1
            self._foreign += update.is_foreign
            all_s = self._mean_s * len(past)
            is_told = self._spent_s >= _TELLING_S
            if update.excludes_monitor:
                self._cannot_replay = (
                    f"what a monitor said after step {self._done} is impossible in the new documents"
                )
            elif update.is_impossible:
                self._cannot_replay = (
                    f"step {self._done}, {step.action} -> {step.response}, is impossible in the new documents"
                )
            elif is_told and all_s > REPLAY_S:
                self._cannot_replay = f"the replay of {len(past)} steps would take about {all_s:.0f} s"
            if self._cannot_replay:
                return

    @property
    def _mean_s(self) -> float:
        return self._spent_s / self._done if self._done else 0.0

    async def _projected(self, running: RunningModel) -> BeliefSummary:
        common = running.engine.layout.common_with(self.model.engine.layout)
        if not common.kept:
            message = f"no variable of the running model is in the new documents, and {self._cannot_replay}"
            hint = "End the mission and start it with the new documents"
            raise ModelError(message, code="AOS112", hint=hint)
        return await self.model.engine.project(await running.engine.export_joint(common), common)

    def _takeover(
        self,
        running: RunningModel,
        past: Past,
        belief: BeliefSummary,
        by: TakeoverWay,
        moved: Mapping[str, float] = {},
    ) -> Takeover:
        row = ModelAdopted(
            self.model.revision,
            self.model.digest,
            running.revision,
            by,
            len(past),
            self._foreign if by == "replay" else 0,
            dict(moved),
            self._cannot_replay if by == "projection" else self._cannot_import,
        )
        return Takeover(self.model, belief, row)


def distances(
    before: Sequence[Marginal], after: Sequence[Marginal], variables: Collection[str]
) -> dict[str, float]:
    """The total variation distance of the marginals of each of the variables that has moved.

    Compounds and arrays count by their parts.
    """
    known = {marginal.variable: marginal for marginal in before}
    moved = {}
    for marginal in after:
        name = _VARIABLE.match(marginal.variable)
        old = known.get(marginal.variable)
        if old is None or name is None or name[0] not in variables:
            continue
        values = old.values.keys() | marginal.values.keys()
        sum_ = sum(abs(old.values.get(value, 0.0) - marginal.values.get(value, 0.0)) for value in values)
        distance = (sum_ + abs(old.others - marginal.others)) / 2
        if distance > _ROUNDING:
            moved[marginal.variable] = distance
    return moved


class Earlier(NamedTuple):
    """A model that another one followed, after so many steps of the mission."""

    model: RunningModel
    until: int


async def retraced(
    earlier: Sequence[Earlier], model: RunningModel, past: Past, known: int = 0
) -> AsyncIterator[BeliefUpdate]:
    """Updates beliefs by each step from `known` on, through the earlier models and then this one.

    Each earlier engine is closed once the next one has its belief, or the walk ends. AosError where a model
    cannot take over as it did.
    """
    models = [*(each.model for each in earlier), model]
    number = known
    try:
        for (before, until), follower in zip(earlier, models[1:], strict=True):
            stretch = Past(past.refuted_below, past.steps[: known + until])
            async for update in replayed(before.engine, stretch, number):
                number += 1
                yield update
            successor, takeover = Successor(follower, SystemClock()), None
            while takeover is None:
                takeover = await successor.take_over(before, stretch)
            await before.engine.close()
        async for update in replayed(model.engine, past, number):
            yield update
    finally:
        for before, _ in earlier:
            await before.engine.close()
