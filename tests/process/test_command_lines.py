import asyncio
import json
from asyncio.subprocess import PIPE
from pathlib import Path

from lamp import LAMP
from models import built_text
from processes import HANG_S

from aos_protocol.messages import WeightedStates
from aos_solver.child.answers.beliefs import import_command
from aos_solver.child.engine import Engine, Restriction
from aos_solver.child.lines.command_line import command_line


class Recorded(Engine):
    """An engine that remembers what it asked."""

    asked: list[str]

    async def _ask(self, command: str, kind: type, **more: float) -> object:
        self.asked.append(command)
        return await super()._ask(command, kind, **more)


async def commands_of(executable: list[Path]) -> list[str]:
    built = await built_text(LAMP)
    executable.append(built.executable)
    Recorded.asked = []
    async with await Recorded.start(built, seed=1) as engine:
        await engine.summary()
        await engine.plan(seed=1, simulations=10, within=Restriction(barred=()), planner="pomcp")
        await engine.ponder(0, seed=1, time_s=0.0)
        await engine.count_processor_time(False)
        await engine.exact_values(2)
        await engine.reach(0.1, 5)
        await engine.may_reach_goal()
        await engine.list_states(100)
        await engine.write_listing()
        await engine.predict(0)
        await engine.update("press", "clicked")
        await engine.update_without_observation("press", ran_probability=0.5)
        await engine.import_belief(await engine.export_belief())
        await engine.reset_belief()
        await engine.draw_belief()
        await engine.reset_world(1)
        await engine.step_world(0)
        await engine.world_state()
        await engine.reset_worlds([1, 2])
        await engine.step_worlds(bytes(8))
        await engine.rate(0.01, 1)
        await engine.rate(0.01, 1, "table")
    return [*Recorded.asked, command_line("restore_belief", change=1)]


async def test_the_engine_names_each_field_that_a_command_lacks(tmp_path):
    executable: list[Path] = []
    lines: list[str] = []
    lacking: list[tuple[str, str]] = []
    for line in await commands_of(executable):
        name, *rest = line.split("\t")
        fields = rest[: rest.index("")] if "" in rest else rest
        # Every question may have a limit to its processor time.
        for field in (name for name in fields if not name.startswith("max_seconds=")):
            lines.append("\t".join(part for part in (name, *rest) if part != field))
            lacking.append((name, field.partition("=")[0]))
    command = [str(executable[0]), "-1", "-1", "1", "widen", "12"]
    asked = "\n".join([command_line("list", max_states=100), *lines]) + "\n"
    engine = await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE)
    printed, _ = await asyncio.wait_for(engine.communicate(asked.encode()), timeout=HANG_S)
    answers = [json.loads(line) for line in printed.splitlines()[2:]]
    assert len(answers) == len(lacking) > 25
    texts = [answer["fault"]["text"] for answer in answers]
    assert texts == [f"{name} has no field {field}" for name, field in lacking]


def test_a_belief_is_a_command_with_a_list():
    belief = WeightedStates(((1.0, "1 0"),), {"room": "3 4"}, 0.5, True, "words")
    assert import_command(belief).split("\t") == [
        "import_belief", "error_bound=0.5", "is_drawn=1", "history=words", "constants=1",
        "", "room", "3 4", "1.0", "1 0",
    ]  # fmt: skip


def test_a_text_is_one_field_whatever_is_in_it():
    assert command_line("update", response="a\tb\n\\n") == "update\tresponse=a\\tb\\n\\\\n"
