from pathlib import Path

import msgspec
import numpy as np
import pytest
from places import PROBLEMS, ROOT

from aos_lab.formats import is_problem_file
from aos_lab.formats.problem_files import read_problem
from aos_lab.formats.problem_writers import with_sensing_by_state, write_problem
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.errors import DocumentError, ModelError, PlanningError
from aos_solver.offline.explicit_model import ExplicitModel, Floats, Ragged


def joint(model: ExplicitModel) -> Floats:
    size = model.size
    dense = np.zeros((size.states, size.actions, size.states, size.observations))
    for row in range(len(model.outcomes)):
        state, action = divmod(row, size.actions)
        begin = model.outcomes.first[row]
        for offset, (after, probability) in enumerate(zip(*model.outcomes.row(row), strict=True)):
            for observation, chance in zip(
                *model.likelihoods.row(model.sensings[begin + offset]), strict=True
            ):
                dense[state, action, after, observation] += probability * chance
    return dense


def test_a_pomdp_file_with_wildcards_matrices_and_numbers_is_read():
    model = read_problem(PROBLEMS / "tiger.pomdp")
    assert model.states == ("left", "right")
    assert model.discount == 0.95
    np.testing.assert_allclose(model.rewards, [[-1, -100, 10], [-1, 10, -100]])
    np.testing.assert_allclose(joint(model)[0, 0], [[0.85, 0.15], [0, 0]])
    np.testing.assert_allclose(joint(model)[1, 2], np.full((2, 2), 0.25))
    np.testing.assert_allclose(model.start_distribution(), [0.5, 0.5])


@pytest.mark.parametrize("ending", [".POMDP", ".PomdpX"])
def test_the_ending_of_a_problem_file_may_have_capital_letters(tmp_path, ending):
    path = tmp_path / f"tiger{ending}"
    write_problem(read_problem(PROBLEMS / "tiger.pomdp"), path)
    assert is_problem_file(path)
    assert read_problem(path).states == ("left", "right")


def test_costs_excluded_starts_resets_and_rewards_by_observation_are_read():
    model = read_problem(PROBLEMS / "costs.pomdp")
    np.testing.assert_allclose(model.start_distribution(), [0.5, 0.5, 0])
    # From s0 `go` reaches s1 in 3 of 4 cases, and from s1 always s2, where it is light for sure.
    np.testing.assert_allclose(model.rewards, [[-1, -1.5], [-1, -6], [-8, 0]])
    np.testing.assert_allclose(joint(model)[2, 1].sum(axis=1), [0.5, 0.5, 0])
    np.testing.assert_allclose(joint(model)[1, 1, 2], [0, 1])


def test_a_factored_file_becomes_the_states_that_can_be_reached():
    model = read_problem(PROBLEMS / "rover.pomdpx")
    assert model.states == ("home,s0", "home,s1", "rock,s0", "rock,s1", "away,s0", "away,s1")
    assert model.actions == ("look", "move", "take")
    assert "rock,bright" in model.observations
    # The rover sees where it is: one start for each place.
    assert [start.weight for start in model.starts] == [0.5, 0.5]
    np.testing.assert_allclose(model.start_distribution(), [0.25, 0.25, 0.2, 0.3, 0, 0])
    numbers = {name: number for number, name in enumerate(model.observations)}
    outcome = joint(model)
    assert outcome[3, 0, 3, numbers["rock,bright"]] == pytest.approx(0.8)
    assert outcome[0, 1, 2].sum() == pytest.approx(0.8)
    assert outcome[0, 1, 0, numbers["home,dull"]] == pytest.approx(0.1)
    # The reward for getting to the rock counts as often as that happens.
    np.testing.assert_allclose(model.rewards[:, 1], [0.8, 0.8, 0, 0, 0, 0])
    np.testing.assert_allclose(model.rewards[2:4, 2], [-10, 10])


def test_a_persistent_variable_keeps_its_own_value(tmp_path):
    """Also where an edge has named that value, and beside a parent that has the same values."""
    text = (PROBLEMS / "rover.pomdpx").read_text()
    kept = '<SubDAG type="persistent" var="{}"/>'
    diagram = f'<Parameter type="DD"><DAG>{kept.format("twin_1")}</DAG></Parameter>'
    start = "<Parameter><Entry><Instance>*</Instance><ProbTable>uniform</ProbTable></Entry></Parameter>"
    parts = {
        '<SubDAG type="deterministic" var="place_1" val="away"/></Edge>\n</Node>': (
            f"{kept.format('place_1')}</Edge></Node>"
        ),
        "<ObsVar": '<StateVar vnamePrev="twin_0" vnameCurr="twin_1">'
        "<ValueEnum>home rock away</ValueEnum></StateVar><ObsVar",
        "</InitialStateBelief>": f"<CondProb><Var>twin_0</Var><Parent>null</Parent>{start}</CondProb>"
        "</InitialStateBelief>",
        "</StateTransitionFunction>": "<CondProb><Var>twin_1</Var><Parent>place_0 twin_0</Parent>"
        f"{diagram}</CondProb></StateTransitionFunction>",
    }
    for old, new in parts.items():
        text = replaced(text, old, new)
    (tmp_path / "twin.pomdpx").write_text(text)
    model, plain = read_problem(tmp_path / "twin.pomdpx"), read_problem(PROBLEMS / "rover.pomdpx")
    twins = [state.rsplit(",", 1) for state in model.states]
    for row in range(len(model.outcomes)):
        state, action = divmod(row, model.size.actions)
        after, chances = model.outcomes.row(row)
        assert {twins[each][1] for each in after} == {twins[state][1]}
        there, expected = plain.outcomes.row(
            plain.states.index(twins[state][0]) * model.size.actions + action
        )
        assert [twins[each][0] for each in after] == [plain.states[each] for each in there]
        np.testing.assert_allclose(chances, expected)


@pytest.mark.parametrize("name", ["tiger.pomdp", "costs.pomdp", "rover.pomdpx"])
def test_a_model_reads_back_as_it_was_written(tmp_path, name):
    model = read_problem(PROBLEMS / name)
    endings = (".pomdpx",) if len(model.starts) > 1 else (".pomdp", ".pomdpx")
    for ending in endings:
        write_problem(model, tmp_path / f"again{ending}")
        again = read_problem(tmp_path / f"again{ending}")
        if len(model.starts) == 1:
            reached = [again.states.index(state.replace(",", "_")) for state in model.states]
            np.testing.assert_allclose(again.rewards[reached], model.rewards)
            same = joint(again)[np.ix_(reached, range(model.size.actions), reached)]
            np.testing.assert_allclose(same.sum(axis=-1), joint(model).sum(axis=-1), atol=1e-12)
        assert again.discount == model.discount
        assert sorted(start.weight for start in again.starts) == [start.weight for start in model.starts]


def test_what_only_one_format_can_say_is_refused_by_the_other(tmp_path):
    model = read_problem(PROBLEMS / "rover.pomdpx")
    with pytest.raises(PlanningError, match=r"told at the start .* which \.pomdp cannot say") as caught:
        write_problem(model, tmp_path / "rover.pomdp")
    assert caught.value.code == "AOS320"


def test_an_observation_of_the_step_itself_splits_the_state_that_follows():
    """The observation tells which of two states was left; problem files know only the state that is
    entered."""
    ragged = Ragged(np.array([0, 1, 2]), np.array([0, 0]), np.array([1.0, 1.0]))
    model = ExplicitModel(
        name="trace",
        discount=0.5,
        states=("here", "there"),
        actions=("go",),
        observations=("from-here", "from-there"),
        rewards=np.array([[1.0], [2.0]]),
        outcomes=ragged,
        sensings=np.array([0, 1]),
        likelihoods=Ragged(np.array([0, 1, 2]), np.array([0, 1]), np.array([1.0, 1.0])),
        starts=(),
    )
    split = with_sensing_by_state(model)
    assert split.model.states == ("here", "here", "there")
    np.testing.assert_array_equal(split.model.outcomes.numbers, [0, 0, 1])
    np.testing.assert_array_equal(split.rows[0, :2], [0, 1])
    np.testing.assert_allclose(split.model.rewards[:, 0], [1, 1, 2])


def replaced(text: str, before: str, after: str) -> str:
    assert before in text
    return text.replace(before, after, 1)


def mistakes(folder: Path, before: str, after: str) -> tuple[Diagnostic, ...]:
    """The mistakes of the file that has a text, once another one stands in its place."""
    (path,) = [PROBLEMS / n for n in ("tiger.pomdp", "rover.pomdpx") if before in (PROBLEMS / n).read_text()]
    (folder / path.name).write_text(replaced(path.read_text(), before, after))
    with pytest.raises(DocumentError) as caught:
        read_problem(folder / path.name)
    return caught.value.diagnostics


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("R: 1 : left", "R: 1 : lft", "21:8 AOS110 there is no state lft. Did you mean `left`?"),
        ("start: uniform", "start: unifrom", "7:8 AOS110 there is no state unifrom. Did you mean `u"),
        ("0.85 0.15", "0.85 0.3", "15:1 AOS122 the probabilities of `O:"),
        ("0.85 0.15", "0.85 1.5", "16:6 AOS122 1.5 is no probability"),
        ("0.15 0.85", "0.15", "15:1 AOS106 3 numbers where 2 rows of 2 are needed"),
        ("0.5\n", "half\n", "9:14 AOS106 half is not a finite number"),
        ("discount: 0.95", "discount: 2", "2:11 AOS106 the discount needs to be"),
        ("discount: 0.95\n", "", "1:0 AOS105 there is no `discount:`"),
        ("left right", "left left", "4:14 AOS103 left is there twice"),
        ("# A tiger", "A tiger", "1:1 AOS102 A is no keyword"),
        ("values: reward", "vaules: reward", "3:1 AOS102 vaules is no keyword"),
        ("start:", "start", "7:1 AOS102 start begins a line without a colon"),
        ("left right", "9" * 5000, "4:9 AOS106 1000000000000000000 is no number of"),
        ("R: 1 : left", f"R: 1 : {'9' * 5000}", "21:8 AOS110 there is no state 99"),
        ("<NumValues>2", f"<NumValues>{'9' * 5000}", "11:1 AOS105 StateVar has no"),
        ("T: * : *", "T: * : * : * ", "9:1 AOS106 `T:` has 4 fields"),
        ("look rock - -", "look rok - -", "66:23 AOS110 there is no value of"),
        ("0.9 0.1 0.2 0.8", "0.9 0.1 0.2", "66:42 AOS106 3 numbers where"),
        ("<Parent>do place_0</Parent>", "<Parent>do plac</Parent>", "32:30 AOS110"),
        ("</Discount>", "</Discont>", "5:16 AOS104 this is not well-formed XML"),
        ("fullyObs", "fullyObs='a' fullyObs", "7:64 AOS104"),
        ("<Discount>0.9</Discount>", "", "3:1 AOS105 there is no Discount"),
        ('type="DD"', 'type="XY"', "33:1 AOS106 XY is no type of Parameter"),
        ('idref="slip"', 'idref="slid"', "39:18 AOS110 there is no SubDAGTemplate"),
        ("<Instance>- -<", "<Instance>- - -<", "58:30 AOS106 the Instance has 3"),
    ],
)
def test_a_mistake_is_told_at_its_place(tmp_path, before, after, told):
    first = mistakes(tmp_path, before, after)[0]
    text = f"{first.span.line}:{first.span.column} {first.code} {first.message}. {first.hint}"
    assert text.startswith(told), text


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("home rock", "home, rock", "8:12 home, has a comma. Names stand between blanks"),
        ('fullyObs="true"', 'fullyObs="yes"', "7:1 fullyObs is true or false, not yes. "),
        ('vnamePrev="worth_0" ', "", "10:1 StateVar needs vnamePrev and vnameCurr. "),
        ("persistent", "persistant", "36:18 persistant is no type of SubDAG. Did you mean `persistent`?"),
        (' idref="slip"', "", "39:18 a template needs idref. "),
        (">0.8<", ">0,8<", "50:18 Terminal needs a number. A decimal is written with a point"),
        (">identity<", ">identiy<", "58:65 identiy is not a number. Did you mean `identity`?"),
        (
            "</Func>",
            "</Fun>",
            "78:3 this is not well-formed XML: mismatched tag. <Func> of line 71 is open here",
        ),
        ("states:", "state:", "4:1 state is no keyword. Did you mean `states`?"),
        ("T: *", "T *", "9:1 T begins a line without a colon. Write `T:`"),
        ("T: listen", "T: listen:", "11:1 a colon before identity. Write `T: listen identity`"),
        ("left open", "left, open", "5:17 open-left, has a comma. Names stand between blanks"),
        ("O: *\nuniform\n", "", "1:0 there is no `O: open-left : left`, nor 3 more. "),
        ("0.85 0.15", "0,85 0.15", "16:1 0,85 is not a finite number. A decimal is written with a point"),
    ],
)
def test_one_mistake_of_a_whole_statement_is_told_once(tmp_path, before, after, told):
    (only,) = mistakes(tmp_path, before, after)
    assert f"{only.span.line}:{only.span.column} {only.message}. {only.hint}" == told


@pytest.mark.parametrize(
    ("rule", "word", "hint"),
    [
        ("T: 0 identty", "identty", "Did you mean `identity`?"),
        ("O: 0 : left unifrom", "unifrom", "Did you mean `uniform`?"),
        ("T: 0 even", "even", "Write numbers, or one of uniform, identity, reset"),
    ],
)
def test_a_word_in_place_of_probabilities_is_told_what_it_was_meant_to_be(tmp_path, rule, word, hint):
    broken = tmp_path / "tiger.pomdp"
    broken.write_text(f"{(PROBLEMS / 'tiger.pomdp').read_text()}\n{rule}\n")
    with pytest.raises(DocumentError) as caught:
        read_problem(broken)
    [first] = [one for one in caught.value.diagnostics if one.code == "AOS106"]
    assert (first.message, first.hint) == (f"{word} stands for no probabilities here", hint)


def test_probabilities_of_a_factored_file_have_to_sum_to_one_where_it_matters(tmp_path):
    broken = tmp_path / "rover.pomdpx"
    text = (PROBLEMS / "rover.pomdpx").read_text()
    broken.write_text(text.replace("<Terminal>0.8</Terminal>", "<Terminal>0.7</Terminal>"))
    with pytest.raises(DocumentError, match=r":31:1: .* of place_1 sum to 0.9 for do=move, place_0=home"):
        read_problem(broken)


def test_too_many_states_are_told(tmp_path):
    (tmp_path / "wide.pomdpx").write_text(
        (PROBLEMS / "rover.pomdpx").read_text().replace("<NumValues>2<", "<NumValues>999999<")
    )
    with pytest.raises(ModelError, match="too large once it is written out"):
        read_problem(tmp_path / "wide.pomdpx")
    with pytest.raises(ModelError, match="more than 3 states") as caught:
        read_problem(PROBLEMS / "rover.pomdpx", max_states=3)
    assert caught.value.code == "AOS220"


def test_the_published_problems_have_their_known_sizes():
    folder = ROOT.parent / "shared" / "problems"
    if not folder.is_dir():
        pytest.skip("needs the published problem files in ../shared/problems, not part of this project")
    sizes = {name: read_problem(folder / f"{name}.pomdpx").size for name in ("Tiger", "TagAvoid", "Hallway2")}
    assert msgspec.structs.astuple(sizes["Tiger"])[:3] == (2, 3, 2)
    # 29 cells for the robot, 29 and "tagged" for the other; what is seen is both places.
    assert msgspec.structs.astuple(sizes["TagAvoid"])[:3] == (870, 5, 58)
    assert sizes["Hallway2"].actions == 5
