"""The middleware service on the real bus, between a scripted registry and a scripted adapter."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
import pytest_asyncio
from mapping_documents import project_in, skill_of

from aos_middleware.settings import Settings
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, SkillError
from aos_protocol.keys import Keys
from aos_protocol.messages import (
    Activate,
    ActivationId,
    Cancel,
    Cancelled,
    MappingQuery,
    MappingState,
    Outcome,
    ProjectQuery,
    ProjectRevision,
    SkillCall,
    SkillResult,
    TopicMessage,
)
from aos_runtime.bus import Bus
from aos_runtime.children import PIPE, Child
from aos_runtime.told_state import state_when

PATIENCE_S = 20.0

SENSE = """\
project: armadillo
response: heard
response_rule: level > 3
response: quiet
response_rule: level <= 3
module_activation: skill
path: /sense
max_duration: 0.5
local_variable: level
topic: /level
message_type: Level
initial_value: 0
code:
return __input.data
"""


HANGING_ADAPTER = """
import asyncio, sys
from aos_protocol.keys import Keys
from aos_protocol.messages import SkillCall
from aos_runtime.bus import Bus
from aos_runtime.parent import die_with_parent

async def hang(call, key):
    print("called", flush=True)
    await asyncio.sleep(60)

async def main():
    async with await Bus.open(sys.argv[1], sender="adapter") as bus:
        await bus.answer(Keys("test").call("/serve"), SkillCall, hang)
        print("serving", flush=True)
        await asyncio.sleep(60)

die_with_parent()
asyncio.run(main())
"""


class Registry:
    """Answers for one project, and announces its revisions."""

    def __init__(self, bus: Bus, keys: Keys, project: Project) -> None:
        self._bus = bus
        self._keys = keys
        self.current = ProjectRevision(1, "digest 1", project)

    async def answer(self, query: ProjectQuery, _: str) -> ProjectRevision:
        assert query.project == "armadillo"
        return self.current

    def announce(self, project: Project) -> None:
        number = self.current.revision + 1
        self.current = ProjectRevision(number, f"digest {number}", project)
        self._bus.tell(self._keys.announced, self.current)


class Adapter:
    """Answers calls as the test says, and remembers them."""

    def __init__(self, bus: Bus, keys: Keys) -> None:
        self._bus = bus
        self._keys = keys
        self._sent: dict[str, int] = {}
        self.calls: list[SkillCall] = []
        self.cancelled: list[str] = []
        self.is_called = asyncio.Event()

    async def serve(self, path: str, answer: Callable[[SkillCall], Awaitable[dict[str, Any]]]) -> None:
        async def run(call: SkillCall, _: str) -> SkillResult:
            self.calls.append(call)
            self.is_called.set()
            return SkillResult(call.id, await answer(call), dict(self._sent))

        await self._bus.answer(self._keys.call(path), SkillCall, run)

    async def serve_cancel(self) -> None:
        async def cancel(request: Cancel, _: str) -> Cancelled:
            self.cancelled.append(request.reason)
            return Cancelled()

        await self._bus.answer(self._keys.cancel, Cancel, cancel)

    def publish(self, topic: str, fields: dict[str, Any]) -> None:
        self._sent[topic] = self._sent.get(topic, 0) + 1
        self._bus.tell(self._keys.topic(topic), TopicMessage(self._sent[topic], fields))


class System:
    """A middleware process with its surroundings, and how the solver speaks to it."""

    def __init__(self, bus: Bus, keys: Keys, run_dir: Path, registry: Registry, adapter: Adapter) -> None:
        self.bus = bus
        self.keys = keys
        self.run_dir = run_dir
        self.registry = registry
        self.adapter = adapter
        self.child: Child | None = None

    async def start(self, endpoint: str, **settings: Any) -> None:
        """Starts the service; returns when it answers."""
        values = Settings(
            robot=self.keys.robot,
            service="middleware",
            endpoint=endpoint,
            run_dir=str(self.run_dir),
            project="armadillo",
            **settings,
        )
        path = self.run_dir / "middleware.json"
        path.write_bytes(msgspec.json.encode(values))
        with (self.run_dir / "middleware.log").open("ab") as log:
            self.child = await Child.start([sys.executable, "-m", "aos_middleware", str(path)], stderr=log)
        async with asyncio.timeout(PATIENCE_S), self.bus.presence(self.keys.live("middleware")) as present:
            async for _, is_alive in present:
                if is_alive:
                    return

    async def stop(self) -> None:
        if self.child is not None:
            await self.child.stop(5.0)

    async def state(self, revision: int) -> MappingState:
        """The state of the mappings once they are those of a revision."""
        return await self._state_when(lambda state: state.revision >= revision)

    async def refusal(self, revision: int) -> MappingState:
        """The state of the mappings once a revision is refused."""
        return await self._state_when(lambda state: state.refused >= revision)

    async def _state_when(self, holds: Callable[[MappingState], bool]) -> MappingState:
        return await state_when(
            self.bus, self.keys.mapping_state, MappingQuery(), MappingState, holds, timeout_s=PATIENCE_S
        )

    async def activate(
        self,
        skill: str,
        step: int = 1,
        parameters: dict[str, Any] | None = None,
        deadline_s: float = 10.0,
        revision: int = 0,
    ) -> Outcome:
        request = Activate(ActivationId("m", 1, step), skill, parameters or {}, deadline_s, revision=revision)
        return await self.bus.ask(self.keys.activate(skill), request, Outcome, timeout_s=PATIENCE_S)

    @property
    def log(self) -> str:
        """What the service has logged."""
        return (self.run_dir / "middleware.log").read_text()


@pytest.fixture
def project(bundles: Path) -> Project:
    """Our armadillo, and a skill that listens."""
    armadillo = project_in(bundles / "armadillo-finer")
    sense = skill_of(SENSE, "sense.am")
    return msgspec.structs.replace(armadillo, skills=(*armadillo.skills, sense))


@pytest_asyncio.fixture
async def system(
    bus: Bus, other: Bus, keys: Keys, endpoint: str, tmp_path: Path, project: Project
) -> AsyncIterator[System]:
    """A running service that has the project."""
    registry = Registry(other, keys, project)
    await other.answer(keys.project, ProjectQuery, registry.answer)
    system = System(bus, keys, tmp_path, registry, Adapter(other, keys))
    try:
        await system.start(endpoint)
        await system.state(1)
        yield system
    finally:
        await system.stop()


async def succeed(_: SkillCall) -> dict[str, Any]:
    return {"success": True}


# --- documents ------------------------------------------------------------------------------------------


async def test_it_takes_the_project_from_the_registry_and_shows_the_modules(system: System) -> None:
    state = await system.state(1)
    assert state == MappingState(
        1, ("navigate", "observe_arm_outstretched", "observe_holding", "pick", "sense", "serve")
    )
    folder = system.run_dir / "generated" / "python"
    assert sorted(path.stem for path in folder.iterdir()) == list(state.skills)


async def test_a_new_revision_is_used_and_the_one_before_it_stays_for_the_running_model(
    system: System,
) -> None:
    await system.adapter.serve("/sense", lambda _: asyncio.sleep(0, {}))
    assert (await system.activate("sense", 1)).response == "quiet"
    renamed = skill_of(SENSE.replace("quiet", "silent"), "sense.am")
    others = tuple(skill for skill in system.registry.current.project.skills if skill.name != "sense")
    project = msgspec.structs.replace(system.registry.current.project, skills=(*others, renamed))
    system.registry.announce(project)
    await system.state(2)
    assert (await system.activate("sense", 2)).response == "silent"
    assert (await system.activate("sense", 3, revision=2)).response == "silent"
    assert (await system.activate("sense", 4, revision=1)).response == "quiet"


async def test_a_revision_that_cannot_be_loaded_changes_nothing_and_is_reported(system: System) -> None:
    await system.adapter.serve("/sense", lambda _: asyncio.sleep(0, {}))
    text = SENSE.replace("path:", "imports: import: no_such_module_at_all\npath:")
    project = system.registry.current.project
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(text, "sense.am"),)))
    assert (await system.refusal(2)).revision == 1
    assert "revision 2 is not used" in system.log
    assert "sense.am:7" in system.log
    assert (await system.activate("sense")).response == "quiet"


# --- outcomes -------------------------------------------------------------------------------------------


async def test_a_skill_is_called_with_the_fields_and_its_result_is_observed(system: System) -> None:
    await system.adapter.serve("/navigate", succeed)
    parameters = {"destination": {"place": "Corridor", "x": 4.0, "y": 0.0, "yaw": 0.5}}
    outcome = await system.activate("navigate", parameters=parameters)
    (call,) = system.adapter.calls
    assert (call.path, call.fields) == ("/navigate", {"x": 4.0, "y": 0.0, "yaw": 0.5})
    assert call.id == outcome.id == ActivationId("m", 1, 1)
    assert 0 < call.deadline_s <= 10.0
    assert (outcome.status, outcome.response, outcome.fault) == ("observed", "arrived", None)
    assert outcome.local_variables["success"] == "true"
    assert 0 < outcome.started_ns <= outcome.ended_ns


async def test_only_messages_of_the_activation_count_and_all_of_them(system: System) -> None:
    async def publish_many(_: SkillCall) -> dict[str, Any]:
        for level in range(200):
            system.adapter.publish("/level", {"data": 0 if level < 199 else 9})
        return {}

    await system.adapter.serve("/sense", publish_many)
    system.adapter.publish("/level", {"data": 7})
    assert (await system.activate("sense", 1)).local_variables == {"level": "9"}
    system.adapter.publish("/level", {"data": 7})
    assert (await system.activate("sense", 2)).response == "heard"


async def test_a_silent_topic_has_its_initial_value_not_that_of_the_last_activation(system: System) -> None:
    async def publish_once(call: SkillCall) -> dict[str, Any]:
        if call.id.step == 1:
            system.adapter.publish("/level", {"data": 9})
        return {}

    await system.adapter.serve("/sense", publish_once)
    assert (await system.activate("sense", 1)).response == "heard"
    assert (await system.activate("sense", 2)).response == "quiet"


async def test_holding_is_decided_from_the_published_gap_and_forces(system: System) -> None:
    async def squeeze(call: SkillCall) -> dict[str, Any]:
        force_n = 4.0 if call.id.step == 1 else 0.0
        fields = {"gap_m": 0.06, "left_force_n": force_n, "right_force_n": 4.0}
        system.adapter.publish("/gripper", fields)
        return {}

    await system.adapter.serve("/sense", squeeze)
    assert (await system.activate("observe_holding", 1)).response == "holding"
    assert (await system.activate("observe_holding", 2)).response == "not_holding"


async def test_an_unknown_skill_is_refused_with_the_nearest_name(system: System) -> None:
    with pytest.raises(SkillError, match="did you mean navigate") as refusal:
        await system.activate("navigat")
    assert refusal.value.code == "AOS501"


async def test_a_path_without_adapter_fails_and_says_what_to_bind(system: System) -> None:
    outcome = await system.activate("pick")
    assert (outcome.status, outcome.response) == ("failed", "")
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS505"
    assert "/pick" in outcome.fault.message
    assert "bind:" in outcome.fault.hint


@pytest.mark.parametrize(
    ("code", "status"),
    [
        ("AOS502", "failed"),
        ("AOS503", "timed_out"),
        ("AOS504", "unknown"),
        ("AOS506", "failed"),
        ("AOS507", "cancelled"),
    ],
)
async def test_an_adapters_error_becomes_a_defined_outcome(system: System, code: str, status: str) -> None:
    async def refuse(_: SkillCall) -> dict[str, Any]:
        raise SkillError("no", code=code, hint="why")

    await system.adapter.serve("/pick", refuse)
    outcome = await system.activate("pick")
    assert (outcome.status, outcome.response) == (status, "")
    assert outcome.fault is not None
    assert (outcome.fault.code, outcome.fault.message, outcome.fault.hint) == (code, "no", "why")


async def test_a_skill_that_does_not_end_is_timed_out_and_stopped(system: System) -> None:
    never = asyncio.Event()

    async def hang(_: SkillCall) -> dict[str, Any]:
        await never.wait()
        return {}

    await system.adapter.serve("/sense", hang)
    await system.adapter.serve_cancel()
    outcome = await system.activate("sense")
    (call,) = system.adapter.calls
    assert call.deadline_s == 0.5
    assert outcome.status == "timed_out"
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS503"
    assert system.adapter.cancelled == ["sense did not end within 0.5 s"]


async def test_the_activations_deadline_counts_where_it_is_shorter(system: System) -> None:
    await system.adapter.serve("/pick", lambda _: asyncio.sleep(30, {}))
    outcome = await system.activate("pick", deadline_s=0.4)
    assert outcome.status == "timed_out"
    assert 0 < system.adapter.calls[0].deadline_s <= 0.4


async def test_a_result_that_no_rule_covers_is_a_failure_with_the_values(system: System) -> None:
    project = system.registry.current.project
    text = SENSE.replace("level <= 3", "level < 0")
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(text, "sense.am"),)))
    await system.state(2)
    await system.adapter.serve("/sense", lambda _: asyncio.sleep(0, {}))
    outcome = await system.activate("sense")
    assert outcome.status == "failed"
    assert outcome.local_variables == {"level": "0"}
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS402"
    assert "level=0" in outcome.fault.message
    assert outcome.fault.diagnostics[0].span.file == "sense.am"


async def test_mapping_code_that_raises_is_a_failure_at_the_documents_line(
    system: System, bundles: Path
) -> None:
    await system.adapter.serve("/pick", lambda _: asyncio.sleep(0, {"sucess": True}))
    outcome = await system.activate("pick")
    assert outcome.status == "failed"
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS401"
    source = (bundles / "armadillo-finer" / "pick.am").read_text().splitlines()
    line = source.index("success = __input.success") + 1
    assert f"pick.am:{line}:11" in outcome.fault.message
    assert "did you mean 'sucess'" in outcome.fault.message


async def test_mapping_code_that_fails_during_the_call_does_not_end_the_call(system: System) -> None:
    ended = asyncio.Event()

    async def publish_wrong(_: SkillCall) -> dict[str, Any]:
        system.adapter.publish("/level", {"wrong": 1})
        await asyncio.sleep(0.2)
        ended.set()
        return {}

    await system.adapter.serve("/sense", publish_wrong)
    outcome = await system.activate("sense")
    assert ended.is_set()
    assert outcome.fault is not None
    assert (outcome.status, outcome.fault.code) == ("failed", "AOS401")


async def test_parameters_that_the_mapping_does_not_find_are_a_failure_without_a_call(
    system: System,
) -> None:
    await system.adapter.serve("/navigate", succeed)
    outcome = await system.activate("navigate", parameters={"destination": {"x": 1.0}})
    assert outcome.fault is not None
    assert (outcome.status, outcome.fault.code) == ("failed", "AOS401")
    assert "navigate.am" in outcome.fault.message
    assert system.adapter.calls == []


# --- at most once ---------------------------------------------------------------------------------------


async def test_a_repeated_id_brings_the_first_outcome_again_and_moves_nothing(
    system: System, endpoint: str
) -> None:
    await system.adapter.serve("/pick", succeed)
    first = await system.activate("pick")
    assert await system.activate("pick") == first
    await system.stop()
    await system.start(endpoint)
    await system.state(1)
    assert await system.activate("pick") == first
    assert len(system.adapter.calls) == 1


async def test_a_repeat_during_the_activation_waits_for_its_outcome(system: System) -> None:
    go_on = asyncio.Event()

    async def wait(_: SkillCall) -> dict[str, Any]:
        await go_on.wait()
        return {"success": True}

    await system.adapter.serve("/pick", wait)
    async with asyncio.TaskGroup() as tasks:
        first = tasks.create_task(system.activate("pick"))
        await system.adapter.is_called.wait()
        second = tasks.create_task(system.activate("pick"))
        with pytest.raises(SkillError, match="running already, for activation m-1-1"):
            await system.activate("pick", step=2)
        go_on.set()
    assert first.result() == second.result()
    assert first.result().response == "pick_succeeded"
    assert len(system.adapter.calls) == 1


@pytest.mark.parametrize("ending", ["killed", "stopped"])
async def test_an_activation_cut_off_with_the_service_is_unknown_and_not_run_again(
    system: System, endpoint: str, ending: str
) -> None:
    never = asyncio.Event()

    async def hang(_: SkillCall) -> dict[str, Any]:
        await never.wait()
        return {}

    await system.adapter.serve("/pick", hang)
    assert system.child is not None
    async with asyncio.TaskGroup() as tasks:
        cut_off = tasks.create_task(_error_of(system.activate("pick")))
        await system.adapter.is_called.wait()
        if ending == "killed":
            system.child.kill()
        status = await system.child.stop(5.0)
    assert status == (-9 if ending == "killed" else 0)
    assert cut_off.result().code in ("AOS601", "AOS604", "AOS606")
    await system.start(endpoint)
    await system.state(1)
    outcome = await system.activate("pick")
    assert outcome.status == "unknown"
    assert outcome.fault is not None
    assert outcome.fault.code == "AOS504"
    assert len(system.adapter.calls) == 1


async def test_an_adapter_killed_during_the_call_leaves_the_outcome_unknown(
    system: System, endpoint: str
) -> None:
    adapter = await Child.start([sys.executable, "-c", HANGING_ADAPTER, endpoint], stdout=PIPE)
    assert await adapter.stdout.readline() == b"serving\n"
    async with asyncio.TaskGroup() as tasks:
        activation = tasks.create_task(system.activate("serve"))
        assert await adapter.stdout.readline() == b"called\n"
        # Later than what is taken for an adapter that was never there.
        await asyncio.sleep(0.3)
        adapter.kill()
    outcome = activation.result()
    assert outcome.fault is not None
    assert (outcome.status, outcome.fault.code) == ("unknown", "AOS504")


async def _error_of(asked: Awaitable[Outcome]) -> AosError:
    with pytest.raises(AosError) as error:
        await asked
    return error.value
