import numpy as np
import pytest

from aos_lab.formats.problem_files import read_problem
from aos_protocol.errors import DocumentError, IntractableError

MDP = """\
discount: 0.9
values: cost
states: a b c
actions: go stay
start: 0.25 0 0.75
T: go
0.5 0.5 0   0 0.5 0.5   0.5 0 0.5
T: stay identity
R: * : * : * 1
R: go : a : b 3
R: stay : c
1 2 4
"""


@pytest.mark.parametrize("text", ["", "# nothing\n", "hello world\n"])
def test_a_file_without_statements_has_mistakes(tmp_path, text):
    file = tmp_path / "empty.pomdp"
    file.write_text(text)
    with pytest.raises(DocumentError) as caught:
        read_problem(file)
    assert {finding.code for finding in caught.value.diagnostics} <= {"AOS102", "AOS105"}


def test_a_rule_that_is_missing_is_told_as_missing(tmp_path):
    file = tmp_path / "missing.pomdp"
    file.write_text("discount: 0.5\nstates: a b\nactions: go\nobservations: x\nT: go : a 0 1\nO: * uniform")
    with pytest.raises(DocumentError) as caught:
        read_problem(file)
    assert [finding.message for finding in caught.value.diagnostics] == ["there is no `T: go : b`"]


def test_names_beyond_ascii_are_read_with_and_without_a_byte_order_mark(tmp_path):
    file = tmp_path / "marked.pomdp"
    text = "discount: 0.5\nstates: größe b\nactions: go\nobservations: x\nT: go identity\nO: * uniform\n"
    for encoding in ("utf-8", "utf-8-sig", "latin-1"):
        file.write_text(text, encoding=encoding)
        assert read_problem(file).states == ("größe", "b"), encoding


def test_without_observations_the_state_is_seen(tmp_path):
    file = tmp_path / "mdp.pomdp"
    file.write_text(MDP)
    model = read_problem(file)
    assert model.observations == model.states
    assert [(start.weight, list(start.states)) for start in model.starts] == [(0.25, [0]), (0.75, [2])]
    np.testing.assert_allclose(model.rewards, [[-2, -1], [-1, -1], [-1, -4]])
    for state, sensing in zip(model.outcomes.numbers, model.sensings, strict=True):
        assert list(model.likelihoods.row(sensing)[0]) == [state]


def test_a_file_with_sensing_needs_observations(tmp_path):
    file = tmp_path / "unnamed.pomdp"
    file.write_text(MDP + "O: * uniform\n")
    with pytest.raises(DocumentError, match=r"has mistakes") as caught:
        read_problem(file)
    assert caught.value.diagnostics[0].message == "there is no `observations:`"


def test_a_row_for_all_changes_where_a_later_line_says_so(tmp_path):
    file = tmp_path / "shared.pomdp"
    lines = ["discount: 0.5", "states: a b", "actions: go stay", "observations: x", "O: * uniform"]
    lines += [
        "T: * : * 0.3 0.7",
        "T: go : a : a 0.6",
        "T: go : a : b 0.4",
        "T: stay : * 0 1",
        "T: stay : b : a 0",
    ]
    file.write_text("\n".join(lines))
    model = read_problem(file)
    rows = [model.outcomes.row(number) for number in range(4)]  # go and stay in a, then in b
    assert [list(numbers) for numbers, _ in rows] == [[0, 1], [1], [0, 1], [1]]
    np.testing.assert_allclose(np.concatenate([chances for _, chances in rows]), [0.6, 0.4, 1, 0.3, 0.7, 1])


def test_the_only_state_may_be_named_as_the_start(tmp_path):
    file = tmp_path / "one.pomdp"
    for start in ("here", "1", "uniform"):
        text = f"discount: 0.5\nstates: here\nactions: 1\nobservations: 1\nstart: {start}\n"
        file.write_text(f"{text}T: * identity\nO: * uniform\n")
        assert list(read_problem(file).start_distribution()) == [1.0]


def test_a_short_file_of_a_model_that_is_too_large_is_refused(tmp_path):
    file = tmp_path / "dense.pomdp"
    file.write_text("discount: 0.9\nstates: 3000\nactions: 4\nobservations: 1\nT: * uniform\nO: * uniform\n")
    with pytest.raises(IntractableError, match="36,000,000 outcomes"):
        read_problem(file)


def test_rewards_for_each_of_many_next_states_are_one_entry_each(tmp_path):
    count = 1500
    lines = [f"discount: 0.5\nstates: {count}\nactions: 20\nobservations: x\nT: * identity\nO: * uniform"]
    lines += [f"R: * : * : {state} : * {state}" for state in range(count)]
    file = tmp_path / "many.pomdp"
    file.write_text("\n".join([*lines, "R: 3 : * : 7 : * -1", "R: 3 : 8 : * : * -2"]))
    rewards = read_problem(file).rewards
    np.testing.assert_allclose(rewards[:, 0], range(count))
    assert list(rewards[6:10, 3]) == [6, -1, -2, 9]
