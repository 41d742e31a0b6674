import asyncio
import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from commands import aos
from processes import COMMAND_S
from texts import write_texts

from aos_deploy.bundles import reachability
from aos_deploy.commands import documents
from aos_language import load
from aos_protocol.errors import ModelError
from aos_solver.building import build as building
from aos_solver.building import project_build
from aos_solver.building.compiler import find_compiler
from aos_solver.child.blame import replay

HALL = """project: hall
horizon: 4
discount: 0.9

state_variable: int place

initial_belief:
state.place = 0;

reward_code:
if (state.place == {goal}) {{ __reward = 10; __isGoalState = true; }}
"""
WALK = """project: hall

dynamic_model:
{code}
__moduleResponse = walked;
"""
OPEN = """project: hall

precondition:
__meetPrecondition = state.place == {door};
violate_penalty: -1

dynamic_model:
__moduleResponse = opened;
"""


@pytest.fixture
def hall(tmp_path) -> Callable[..., Path]:

    def write(code: str, *, goal: str = "3", door: str = "2") -> Path:
        files = {
            "hall.ef": HALL.format(goal=goal),
            "walk.sd": WALK.format(code=code),
            "open.sd": OPEN.format(door=door),
        }
        write_texts(files, tmp_path)
        return tmp_path

    return write


def linted(folder: Path, exit_code: int = 0) -> dict[str, Any]:
    """The findings by code, each as severity, place and hint; there is one of each code here."""
    result = aos("lint", folder, "--format", "json")
    assert result.exit_code == exit_code, result.output
    found = json.loads(result.stdout)["diagnostics"]
    return {
        finding["code"]: (finding["severity"], _place(finding["span"]), finding["hint"]) for finding in found
    }


def test_a_skill_whose_list_of_parameters_is_empty_is_told(hall):
    folder = hall("state__.place = std::min(state.place + 1, 3);")
    listing = (
        "parameter: int to\navailable_parameters_code:\nfor (int i = 0; i < state.place; i++) {listed}\n"
    )
    listed = listing.format(listed="__possibleParameters.push_back(std::make_tuple(i));")
    write_texts({"jump.sd": f"project: hall\n{listed}dynamic_model:\n__moduleResponse = jumped;\n"}, folder)
    assert linted(folder)["AOS119"][:2] == ("warning", "jump.sd:4")


def _place(span: dict[str, Any]) -> str:
    return f"{span['file']}:{span['line']}"


def test_a_fault_of_model_code_names_its_document_line(hall: Callable[..., Path], monkeypatch):
    """A compiler that does not check divisions derives that `left` is 1; others: test_fault_statements."""
    code = "int left = state.place == 9 ? 1 : 0;\nstate__.place += 3 / left;"
    monkeypatch.setattr(replay, "REPLAY_DEADLINE_S", COMMAND_S)
    result = aos("plan", hall(code), "--time", "0.1")
    assert isinstance(result.exception, ModelError)
    (diagnostic,) = result.exception.diagnostics
    assert (diagnostic.code, diagnostic.span.file, diagnostic.span.line) == ("AOS210", "walk.sd", 5)
    assert "divided by zero" in diagnostic.message


STEP = "state__.place = state.place + 1;\n"
REACHED = [
    (STEP + "if (state.place == 2) throw 1;", "AOS215"),
    (STEP + "int i = 0; while (i >= 0) { i = state.place; state__.place = i; }", "AOS211"),
    ("state__.place += AOS.Bernoulli(0.5) ? 1 : 10;\nif (state.place == 25) throw 1;", "AOS215"),
    (STEP + "while (true) { if (AOS.SampleUniform(0, 1) < 0.5 && state.place < 0) break; }", "AOS211"),
    (STEP + "if (AOS.SampleNormal(0, 1) > -9) throw 1;", "AOS215"),
]
"""The last two cannot be enumerated, so they are met by random actions."""


@pytest.mark.parametrize(
    ("code", "error_code"), REACHED, ids=["exception", "loop", "behind the goal", "draws", "drawn"]
)
def test_a_fault_that_the_actions_lead_to_is_an_error_of_lint(
    hall: Callable[..., Path], monkeypatch, code, error_code
):
    monkeypatch.setattr(replay, "REPLAY_DEADLINE_S", COMMAND_S)
    severity, place, _ = linted(hall(code), exit_code=1)[error_code]
    assert (severity, place) == ("error", "walk.sd:5")


def test_steps_that_take_long_and_end_are_a_warning(hall: Callable[..., Path], monkeypatch):
    monkeypatch.setattr(reachability, "MAX_CPU_S", 0.1)
    # Each turn needs the one before, so that no compiler makes several at once.
    slow = "int s = 0; for (int i = 0; i < 200000000; i++) s = (5 * s + (i ^ state.place)) % 7;\n"
    severity, place, hint = linted(hall(slow + "state__.place = state.place + 1 + s % 2;"))["AOS211"]
    assert (severity, place) == ("warning", "walk.sd:4")
    assert hint.startswith("Make steps cheaper")


def test_steps_that_wait_for_a_processor_are_not_slow(hall: Callable[..., Path], monkeypatch):
    monkeypatch.setattr(reachability, "MAX_CPU_S", 0.1)
    waiting = "timespec pause{0, 300'000'000}; nanosleep(&pause, nullptr);\n"
    assert linted(hall(waiting + STEP)) == {}


@pytest.mark.parametrize("draw", ["", "state__.place += AOS.SampleUniform(0, 1) > 2;\n"])
def test_a_loop_that_no_draw_ends_is_a_warning(hall: Callable[..., Path], draw):
    loop = "while (state.place > 0) { if (AOS.Bernoulli(0.5) && state.place > 1) break; }"
    severity, place, hint = linted(hall(draw + STEP + loop))["AOS211"]
    assert (severity, place) == ("warning", f"walk.sd:{5 + bool(draw)}")
    assert hint.startswith("Such a step ends the mission as a failure")


def test_a_loop_that_chance_ends_is_no_error(hall: Callable[..., Path]):
    loop = "while (AOS.Bernoulli(0.5) || AOS.Bernoulli(0.999)) {}"
    assert "AOS211" not in linted(hall(STEP + loop))


RECURSIVE = """auto sum = []<int N>(auto self, std::integral_constant<int, N>) -> int {
    if constexpr (N == 0) return 0;
    else return N + self(self, std::integral_constant<int, N - 1>{}) %s;
};
state__.place = sum(sum, std::integral_constant<int, %d>{});"""


BRANCHING = """auto sum = []<int N, int K>(
    auto self, std::integral_constant<int, N>, std::integral_constant<int, K>) -> int {
    if constexpr (N == 0) return K;
    else return self(self, std::integral_constant<int, N - 1>{}, std::integral_constant<int, 2 * K>{}) +
                self(self, std::integral_constant<int, N - 1>{}, std::integral_constant<int, 2 * K + 1>{});
};
state__.place = sum(sum, std::integral_constant<int, 16>{}, std::integral_constant<int, 0>{});"""
"""A hundred thousand functions, none of them deep."""


def test_templates_that_recurse_deeply_are_refused_at_their_line(hall: Callable[..., Path]):
    # Gcc tells where the function calls itself, clang where it begins.
    line = 6 if asyncio.run(find_compiler()).family == "gcc" else 4
    assert linted(hall(RECURSIVE % ("", 800)), exit_code=1)["AOS201"][1] == f"walk.sd:{line}"


def test_a_skill_with_a_mistake_has_no_second_one_where_the_environment_looks_at_its_parameters(
    hall: Callable[..., Path],
):
    folder = hall("")
    with (folder / "hall.ef").open("a") as environment:
        environment.write(
            "\naction_parameter: int far\n\n"
            "extrinsic_code:\nif (walk != NULL && walk->steps == 2) state_.place = 1;\n"
        )
    walk = WALK.format(code="").replace(
        "dynamic_model:", "parameter: int steps\nviolate_penalty: 1,5\n\ndynamic_model:"
    )
    (folder / "walk.sd").write_text(walk)
    result = aos("lint", folder, "--format", "json")
    errors = [one for one in json.loads(result.stdout)["diagnostics"] if one["severity"] == "error"]
    assert [(one["code"], _place(one["span"])) for one in errors] == [("AOS106", "walk.sd:4")]


def test_what_to_write_for_a_distribution_is_told_beside_an_unknown_name(hall: Callable[..., Path]):
    folder = hall("std::bernoulli_distribution far(0.9);\nstate__.place = far(own) + state.plaze;")
    told = linted(folder, exit_code=1)
    assert {code: place for code, (_, place, *_) in told.items() if code in ("AOS110", "AOS124")} == {
        "AOS110": "walk.sd:5",
        "AOS124": "walk.sd:4",
    }


def test_code_that_computes_too_long_while_it_is_compiled_is_refused(hall: Callable[..., Path], monkeypatch):
    monkeypatch.setattr(building, "MODEL_CPU_S", 1.0)
    monkeypatch.setattr(building, "ENGINE_SHARE", 0.0)
    folder = hall(BRANCHING)
    assert linted(folder, exit_code=1)["AOS202"][:2] == ("error", "walk.sd:4")


def test_a_model_whose_goal_and_doors_can_be_reached_is_clean_and_its_documents_are_lowered_once(
    hall: Callable[..., Path], monkeypatch
):
    calls: Counter[str] = Counter()

    def counted(module: ModuleType, name: str):
        original = getattr(module, name)

        def call(*arguments: Any, **options: Any) -> Any:
            calls[name] += 1
            return original(*arguments, **options)

        monkeypatch.setattr(module, name, call)

    counted(load, "load_files")
    counted(documents, "load_files")
    counted(project_build, "lower")
    counted(project_build, "emit")
    assert linted(hall("state__.place = state.place + 1;  // once")) == {}
    assert calls == {"load_files": 1, "lower": 1, "emit": 1}


def test_a_goal_and_a_precondition_that_nothing_leads_to_are_told_with_the_extent(hall: Callable[..., Path]):
    found = linted(hall("state__.place = (state.place + 1) % 5;", goal="7", door="6"))
    extent = "Looked at all that can be reached, 5 states, up to 4 actions from the start"
    assert found == {"AOS132": ("warning", "hall.ef:10", extent), "AOS131": ("warning", "open.sd:4", extent)}


def test_initial_states_in_which_the_mission_is_over_are_told(hall: Callable[..., Path]):
    folder = hall("state__.place = (state.place + 1) % 5;", goal="0")
    assert linted(folder)["AOS150"][:2] == ("warning", "hall.ef:10")
    plan = aos("plan", folder, "--time", "0.1")
    assert (plan.exit_code, plan.exception.code) == (1, "AOS302")
    environment = folder / "hall.ef"
    drawn = "state.place = AOS.Bernoulli(0.25) ? 0 : 1;"
    environment.write_text(environment.read_text().replace("state.place = 0;", drawn))
    assert linted(folder)["AOS150"][:2] == ("remark", "hall.ef:10")
    assert "before its first step: goal with probability 0.250" in aos("plan", folder, "--exact").stderr


def test_where_the_search_does_not_see_all_it_remarks_a_missing_goal_only(hall: Callable[..., Path]):
    found = linted(hall("state__.place = state.place + 1;", goal="-1", door="-1"))
    assert found.keys() == {"AOS132"}
    severity, place, hint = found["AOS132"]
    assert (severity, place) == ("remark", "hall.ef:10")
    assert hint.startswith("Looked at 1")


def test_a_goal_beyond_what_could_be_looked_at_is_not_remarked_on(hall: Callable[..., Path]):
    widens = "state__.place = state.place * 400 + AOS.SampleDiscrete(vector<double>(400, 0.0025));"
    assert linted(hall(widens, goal="64000000", door="-1")) == {}


def test_a_search_that_ends_for_its_time_is_told_wherever_it_was(hall: Callable[..., Path], monkeypatch):
    """Some of the searches end in code of the documents, and the others between two pieces of it."""
    monkeypatch.setattr(reachability, "MAX_CPU_S", 0.02)  # Half of what it takes to look at all.
    widens = "state__.place = state.place * 300 + AOS.SampleDiscrete(vector<double>(300, 1.0 / 300));"
    folder = hall(widens, goal="-1", door="-1")
    for _ in range(10):
        ((code, (severity, place, hint)),) = linted(folder).items()
        assert "Looked at " in hint
        told = (code, severity, place == "hall.ef:1")
        assert told in {("AOS132", "remark", True), ("AOS211", "warning", False)}


def test_an_initial_belief_that_cannot_be_enumerated_is_no_reason_for_remarks(hall: Callable[..., Path]):
    folder = hall("state__.place = state.place;", goal="-1", door="-1")
    environment = folder / "hall.ef"
    drawn = "state.place = AOS.SampleNormal(0, 1) > 0;"
    environment.write_text(environment.read_text().replace("state.place = 0;", drawn))
    assert linted(folder) == {}
