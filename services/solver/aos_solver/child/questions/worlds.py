"""The questions of simulated worlds: hidden states that the model moves."""

from base64 import b64encode
from collections.abc import Sequence

from aos_solver.child.answers.worlds import EngineStep, Worlds, WorldStart, WorldState, WorldStep, WorldSteps
from aos_solver.child.lines.command_line import command_line, numbers_by_name
from aos_solver.child.questions.asking import Asking


class WorldQuestions(Asking):
    """One world for a mission without a robot, or many side by side."""

    async def reset_world(self, seed: int) -> WorldStart:
        """Starts a hidden state, drawn from the initial belief, for missions without a robot."""
        command = command_line("reset_world", seed=seed)
        start = await self._ask(command, WorldStart)
        self._world = [command]
        return start

    async def begin_mission_in_world(self, idle: int) -> WorldStart:
        """Begins another mission in the world as it is, after so many steps of extrinsic changes alone."""
        command = command_line("begin_mission_in_world", idle=idle)
        start = await self._ask(command, WorldStart)
        self._world.append(command)
        return start

    async def step_world(self, index: int) -> WorldStep:
        """Runs an action on the hidden state, by the model."""
        command = command_line("step_world", action=index)
        step = await self._ask(command, EngineStep)
        self._world.append(command)
        observed = self.observed.get(self.description.actions[index].skill, ())
        numbers = numbers_by_name(observed, step.numbers)
        return WorldStep(step.reward, step.response, step.ending, numbers, step.violations)

    async def monitor_world(self) -> dict[str, str]:
        """Asks each monitor, by the model, what it says of the hidden state."""
        responses = {}
        for monitor in self.description.monitors:
            command = command_line("step_world", action=self._index_of_monitor(monitor))
            responses[monitor] = (await self._ask(command, EngineStep)).response
            self._world.append(command)
        return responses

    async def world_state(self) -> str:
        """The hidden state as text for people."""
        return (await self._ask("show_world", WorldState)).state

    async def reset_worlds(self, seeds: Sequence[int]) -> Worlds:
        """Starts a hidden state for each seed, to be acted in side by side."""
        return await self._ask(command_line("reset_worlds", seeds), Worlds)

    async def step_worlds(self, indices: bytes) -> WorldSteps:
        """Runs an action in each world, by the bytes of an int32 for each; -1 starts a world anew."""
        return await self._ask(command_line("step_worlds", actions=b64encode(indices).decode()), WorldSteps)
