"""Claims that something never happens, about skills and states that no document has, are mistakes."""

from __future__ import annotations

from pathlib import Path

import pytest

from aos_lab.trials.files import read_test_file
from aos_protocol.errors import DeployError

DOCUMENTS = {
    "walker.ef": """project: walker
horizon: 4
define_type: Place
enum_members: here, there
state_variable: Place at
state_variable: bool lit
reward_code:
if (state.at == there && state.lit) { __reward = 10; __isGoalState = true; }
""",
    "walk.sd": """project: walker
parameter: Place to
dynamic_model:
state__.at = AOS.Bernoulli(0.8) ? to : state.at;
__moduleResponse = state__.at == to ? arrived : stuck;
""",
    "light.sd": "project: walker\ndynamic_model:\nstate__.lit = true;\n",
    "say.sd": 'project: walker\ndynamic_model:\n__moduleResponseStr = state.lit ? "lit" : "dark";\n',
}
DEPLOY = "aos: 1\nrobot: walker\nbundles: [bundle]\nleave_out: [say]\nbind: {'*': model}\n"


def found(folder: Path, claim: str, more: str = "") -> list[str]:
    """The mistakes of a file with a test of one claim."""
    (folder / "bundle").mkdir()
    for name, text in DOCUMENTS.items():
        (folder / "bundle" / name).write_text(text)
    (folder / "walker.yaml").write_text(DEPLOY + more)
    test = f"aos: 1\ntests:\n  t:\n    deploy: walker.yaml\n    claims:\n      - says: so\n        {claim}\n"
    (folder / "tests.yaml").write_text(test)
    try:
        read_test_file(folder / "tests.yaml")
    except DeployError as error:
        return [f"{each.span.line} {each.message}. {each.hint}" for each in error.diagnostics]
    return []


@pytest.mark.parametrize(
    ("claim", "mistake"),
    [
        ("never: wlak", "the skill wlak, which no document describes. Did you mean `walk`?"),
        ("never: 'light | wlak*'", "the skill wlak*, which"),
        (
            "never: walk(too=there)",
            "the parameter too of walk, which has none of that name. Did you mean `to`?",
        ),
        ("never: walk(to=their)", "the value their of to, which it never has. Did you mean `there`?"),
        (
            "never: walk > arived",
            "the response arived of walk, which never gives it. Did you mean `arrived`?",
        ),
        ("never_state: att=there", "the state variable att, which no document declares. Did you mean `at`?"),
        ("never_state: at=ther e | at=their", "the value their of at, which it never has"),
        ("goal: true\n        when: {some: wlak}", "the skill wlak, which"),
    ],
)
def test_a_name_that_no_mission_can_have_is_a_mistake_at_its_claim(
    tmp_path: Path, claim: str, mistake: str
) -> None:
    (only,) = found(tmp_path, claim)
    assert only.startswith(f"6 a claim names {mistake}")


@pytest.mark.parametrize(
    "claim",
    [
        "never: walk(to=the?e) > no observation",
        "never: 'w* | walk*there* | *(to=here) | say > anything | light > Default*'",
        "never_state: at=there, lit=tr | t=here | world_ending=goal | anything else",
    ],
)
def test_what_a_mission_can_have_is_none(tmp_path: Path, claim: str) -> None:
    assert found(tmp_path, claim) == []


def test_where_documents_may_come_into_a_folder_their_names_are_not_known(tmp_path: Path) -> None:
    assert found(tmp_path, "never: wlak", "watch: drop\n") == []
