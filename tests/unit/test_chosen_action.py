import pytest
from projects import text_project
from scripted_models import ScriptedModel, scripted

PARAMETERLESS = "project: test\ndynamic_model:\n"


def skill_over(values: str) -> str:
    possible = (
        f"for (int by : std::vector<int>{{{values}}}) __possibleParameters.push_back(std::make_tuple(by));"
    )
    return f"project: test\nparameter: int by\navailable_parameters_code:\n{possible}\ndynamic_model:\n"


BIRD = {
    "bird.ef": """project: test
horizon: 7
discount: 0.95
state_variable: int seen
code:
state.seen = 0;
extrinsic_code:
state_.seen = (fly != NULL) + 2 * (rest != NULL) + 4 * (never != NULL);
if (turn != NULL) state_.seen += 10 * turn->by;
if (lean) state_.seen += 100 * lean->by;
if (dive && dive->to.depth_m > 2 || NULL != dive && turn) state_.seen = rows[dive->row] + dive->to.depth_m;
else state_.seen += dive == NULL ? 0 : dive->to.depth_m;
__reward = fly != NULL ? -1 : 0;
""",
    "fly.sd": PARAMETERLESS,
    "rest.sd": PARAMETERLESS,
    "sing.sd": PARAMETERLESS,
    "turn.sd": skill_over("2, 3"),
    "lean.sd": skill_over("4"),
    "never.sd": skill_over(""),
}


@pytest.fixture(scope="module")
def bird() -> ScriptedModel:
    return scripted(text_project(BIRD))


@pytest.mark.parametrize(
    ("action", "seen"),
    [("fly", 1), ("rest", 2), ("sing", 0), ("turn(by=2)", 20), ("turn(by=3)", 30), ("lean(by=4)", 400)],
)
def test_only_the_chosen_skill_is_seen(bird: ScriptedModel, action, seen):
    assert bird.play(action).values("seen") == ["0", str(seen)]


def test_a_skill_is_charged_for_itself_alone(bird: ScriptedModel):
    assert bird.play("fly", "rest", "fly", "sing").rewards == [-1, 0, -1, 0]
