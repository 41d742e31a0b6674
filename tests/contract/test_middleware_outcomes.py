import asyncio
import math
from typing import Any

import msgspec
import pytest
from mapping_documents import skill_of
from middleware_system import SENSE, System, answering, assert_ended, hang, succeed
from places import BUNDLES

from aos_language.derived_mapping import derived_mapping
from aos_language.findings import Findings
from aos_language.reading.files import read_documents
from aos_protocol.documents import Skill, SkillModel
from aos_protocol.errors import SkillError
from aos_protocol.messages import ActivationId, SkillCall, SkillResult


async def test_a_skill_is_called_with_the_fields_and_its_result_is_observed(system: System):
    await system.adapter.serve("/navigate", succeed)
    parameters = {"destination": {"place": "Corridor", "x": 4.0, "y": 0.0, "yaw": 0.5}}
    outcome = await system.activate("navigate", parameters=parameters)
    (call,) = system.adapter.calls
    assert (call.path, call.fields) == ("/navigate", {"x": 4.0, "y": 0.0, "yaw": 0.5})
    assert call.id == outcome.id == ActivationId("m", 1)
    assert call.deadline_s == 10.0, "the start of the mapping's process takes nothing of it"
    assert (outcome.status, outcome.response, outcome.fault) == ("observed", "arrived", None)
    assert outcome.local_variables["success"] == "true"
    assert 0 < outcome.started_ns <= outcome.ended_ns


async def test_a_skill_with_a_skill_document_alone_is_called_and_observed(system: System):
    sees = b"project: armadillo\nparameter: tLocation place\ndynamic_model:\n__moduleResponse = seen;\n"
    model = read_documents({"see.sd": sees}, Findings())["see.sd"].content
    assert isinstance(model, SkillModel)
    project = system.registry.current.project
    skill = Skill(model, derived_mapping(model, project.environment))
    system.registry.announce(msgspec.structs.replace(project, skills=(skill,)))
    await system.state(system.registry.current.revision)
    endless = "e" * 9_000_000  # The bus carries it once, and not in a text and a local variable.
    results = iter([{"response": "seen"}, {"success": True}, {"response": "sen"}, {"response": endless}])

    async def answer(_: SkillCall) -> dict[str, Any]:
        return next(results)

    await system.adapter.serve("/see", answer)
    await system.can_run("see")
    parameters = {"place": {"place": "Corridor", "x": 4.0, "y": 0.0, "yaw": 0.5}}
    outcomes = [await system.activate("see", step, parameters=parameters) for step in (1, 2, 3, 4)]
    assert system.adapter.calls[0].fields == parameters
    assert [(outcome.status, outcome.response) for outcome in outcomes] == [
        ("observed", "seen"), ("unknown", ""), ("unknown", ""), ("unknown", ""),
    ]  # fmt: skip
    assert outcomes[3].local_variables["response"].endswith("e... (9,000,002 characters)")
    faults = [outcome.fault for outcome in outcomes]
    assert faults[1] is not None
    assert faults[2] is not None
    assert faults[1].message.endswith("the result of /see has no `response`: it has `success`")
    assert (faults[2].code, faults[2].hint) == ("AOS402", "Did you mean `seen`?")


async def with_sense(system: System, text: str):
    project = system.registry.current.project
    others = [skill for skill in project.skills if skill.name != "sense"]
    skills = (*others, skill_of(text, "sense.am"))
    system.registry.announce(msgspec.structs.replace(project, skills=skills))
    await system.state(2)


async def test_only_messages_of_the_activation_count_and_all_of_them(system: System):
    async def publish_many(call: SkillCall) -> dict[str, Any]:
        for level in range(200 if call.id.step < 3 else 0):
            system.adapter.publish("/level", {"data": 0 if level < 199 else 9})
        return {}

    await system.adapter.serve("/sense", publish_many)
    system.adapter.publish("/level", {"data": 7})
    assert (await system.activate("sense", 1)).local_variables == {"level": "9"}
    system.adapter.publish("/level", {"data": 7})
    assert (await system.activate("sense", 2)).response == "heard"
    # A topic that is silent has its initial value, and not that of the last activation.
    assert (await system.activate("sense", 3)).response == "quiet"


async def test_messages_that_come_faster_than_code_evaluates_them_are_a_fault(system: System, monkeypatch):
    async def publish_many(_: SkillCall) -> dict[str, Any]:
        for _ in range(100):
            system.adapter.publish("/level", {"data": 9})
        return {}

    monkeypatch.setattr("aos_middleware.activations.heard_topics.EVALUATE_S", 0.1)
    slow = SENSE.replace("code:\n", "code:\nimport time\ntime.sleep(0.1)\n")
    await with_sense(system, slow)
    await system.adapter.serve("/sense", publish_many)
    outcome = await system.activate("sense", 1)
    assert_ended(outcome, "unknown", "AOS403", "messages on /level come faster than code evaluates them")


async def test_a_first_message_that_comes_behind_the_answer_is_awaited(system: System):
    async def publish_behind(call: SkillCall) -> dict[str, Any]:
        if call.id.step == 1:
            asyncio.get_running_loop().call_later(0.02, system.adapter.publish, "/level", {"data": 9})
        return {}

    await with_sense(system, SENSE.replace("initial_value: 0\n", ""))
    await system.adapter.serve("/sense", publish_behind)
    assert (await system.activate("sense", 1)).response == "heard"
    why = "; level is null; level has no value, for no message came on /level"
    assert_ended(await system.activate("sense", 2), "unknown", "AOS401", why)


@pytest.mark.parametrize(
    ("topic", "sent_at", "told"),
    [
        ("/levels", 1, "Did you mean `/levels`?"),
        ("/unlike", 1, "No adapter has sent on it"),
        ("/level", 0, "They come between calls"),
        ("/level", 1, ""),
    ],
)
async def test_a_topic_on_which_nothing_ever_comes_is_told_once(
    system: System, topic: str, sent_at: int, told: str
):
    async def publish(call: SkillCall) -> dict[str, Any]:
        if call.id.step == sent_at:
            system.adapter.publish(topic, {"data": 9})
        return {}

    await system.adapter.serve("/sense", publish)
    if sent_at == 0:
        system.adapter.publish(topic, {"data": 9})
    outcomes = [await system.activate("sense", step) for step in range(1, 8)]
    assert {outcome.response for outcome in outcomes} == ({"quiet"} if told else {"heard", "quiet"})
    said = [notice for outcome in outcomes for notice in outcome.notices]
    assert said == [f"no message has come on /level in 3 calls of skills. {told}"] * bool(told)


async def test_messages_that_an_adapter_could_not_send_are_told_where_the_mapping_hears_them(system: System):
    async def publish(_: SkillCall) -> dict[str, Any]:
        system.adapter.publish("/level", {"data": 9})
        return {}

    def changed(result: SkillResult) -> SkillResult:
        return msgspec.structs.replace(result, lost={"/level": 1200, "/unheard": 7})

    await system.adapter.serve("/sense", publish, changed)
    outcome = await system.activate("sense", 1)
    told = (
        "sense: 1,200 messages on /level came too fast for the adapter to send them, the oldest of the call"
    )
    assert (outcome.response, outcome.notices) == ("heard", (told,))


async def test_a_number_that_is_not_finite_is_told_once_for_each_field(system: System):
    async def look(call: SkillCall) -> dict[str, Any]:
        system.adapter.publish("/level", {"data": math.nan})
        last = {"last": math.nan} if call.id.step == 3 else {}
        return {"lux": math.nan, "pose": {"x": math.inf, "y": 1.0}, "ranges": [math.inf], **last}

    await system.adapter.serve("/sense", look)
    said = [(await system.activate("sense", step)).notices for step in (1, 2, 3)]
    assert [[notice.partition(",")[0] for notice in notices] for notices in said] == [
        [
            "data of /level is nan",
            "lux of the result of sense is nan",
            "pose.x of the result of sense is inf",
        ],
        [],
        ["last of the result of sense is nan"],
    ]
    assert ["x != x" in notice for notice in said[0]] == [True, True, False]


async def test_holding_is_decided_from_the_published_gap_and_forces(system: System):
    async def squeeze(call: SkillCall) -> dict[str, Any]:
        force_n = 4.0 if call.id.step == 1 else 0.0
        fields = {"gap_m": 0.06, "left_force_n": force_n, "right_force_n": 4.0}
        system.adapter.publish("/gripper", fields)
        return {}

    await system.adapter.serve("/sense", squeeze)
    assert (await system.activate("observe_holding", 1)).response == "holding"
    assert (await system.activate("observe_holding", 2)).response == "not_holding"


async def test_what_cannot_be_called_says_why(system: System):
    with pytest.raises(SkillError, match="Did you mean `navigate`") as refusal:
        await system.activate("navigat")
    assert refusal.value.code == "AOS501"
    await system.adapter.serve("/navigate", succeed)
    outcome = await system.activate("navigate", parameters={"destination": {"x": 1.0}})
    assert_ended(outcome, "failed", "AOS401", "navigate.am")
    assert system.adapter.calls == []
    outcome = await system.activate("pick", 2)
    assert outcome.response == ""
    assert_ended(outcome, "refused", "AOS505", "/pick Name one for /pick under `bind:`")


async def test_an_adapters_error_becomes_a_defined_outcome(system: System):
    statuses = {
        "AOS502": "refused", "AOS503": "timed_out", "AOS504": "unknown", "AOS506": "refused",
        "AOS507": "cancelled", "AOS510": "failed",
    }  # fmt: skip

    async def refuse(call: SkillCall) -> dict[str, Any]:
        raise SkillError("no", code=[*statuses][call.id.step], hint="why")

    await system.adapter.serve("/pick", refuse)
    await system.adapter.serve_cancel("/pick")
    for step, (code, status) in enumerate(statuses.items()):
        outcome = await system.activate("pick", step)
        assert (outcome.status, outcome.response) == (status, "")
        assert outcome.fault is not None
        assert (outcome.fault.code, outcome.fault.message, outcome.fault.hint) == (code, "no", "why")


async def test_a_skill_that_does_not_end_is_timed_out_and_stopped(system: System):
    await system.adapter.serve("/sense", hang)
    await system.adapter.serve_cancel("/sense")
    outcome = await system.activate("sense")
    (call,) = system.adapter.calls
    assert call.deadline_s == 0.5
    assert_ended(outcome, "timed_out", "AOS503")
    assert system.adapter.cancelled == ["sense did not end within 0.5 s"]
    # The deadline of the activation counts where it is shorter.
    assert (await system.activate("sense", 2, deadline_s=0.1)).status == "timed_out"
    assert system.adapter.calls[1].deadline_s <= 0.1


async def test_a_result_that_no_rule_covers_is_unknown_with_the_values(system: System):
    project = system.registry.current.project
    text = SENSE.replace("level <= 3", "level < 0")
    system.registry.announce(msgspec.structs.replace(project, skills=(skill_of(text, "sense.am"),)))
    await system.state(2)
    await system.adapter.serve("/sense", answering({}))
    outcome = await system.activate("sense")
    assert_ended(outcome, "unknown", "AOS402", "level=0")
    assert outcome.local_variables == {"level": "0"}
    assert outcome.fault
    assert outcome.fault.diagnostics[0].span.file == "sense.am"


async def test_mapping_code_that_raises_is_unknown_at_the_documents_line(system: System):
    await system.adapter.serve("/pick", answering({"sucess": True}))
    outcome = await system.activate("pick")
    source = (BUNDLES / "armadillo-finer" / "pick.am").read_text().splitlines()
    line = source.index("success = __input.success") + 1
    for told in (f"pick.am:{line}:11", "did you mean 'sucess'"):
        assert_ended(outcome, "unknown", "AOS401", told)


async def test_mapping_code_that_fails_during_the_call_does_not_end_the_call(system: System):
    ended = asyncio.Event()

    async def publish_wrong(_: SkillCall) -> dict[str, Any]:
        system.adapter.publish("/level", {"wrong": 1})
        await system.logged("sense goes on, but its mapping failed")
        ended.set()
        return {}

    await system.adapter.serve("/sense", publish_wrong)
    outcome = await system.activate("sense")
    assert ended.is_set()
    assert_ended(outcome, "unknown", "AOS401")
