import pytest

from aos_protocol.errors import StudyError
from aos_solver.study.supposing import Supposition, changed_files, supposition_of

FILES = {"pick.sd": b"cost:\n  __reward = -2;\n  double p = a-0.5 + 3; // odds\n  none\n"}


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("holding=true:0.5", Supposition("holding", "true", 0.5)),
        ("cell[1,2].name = a:b : 1", Supposition("cell[1,2].name", "a:b", 1.0)),
    ],
)
def test_a_belief_has_a_variable_a_value_and_a_probability(text, meant):
    assert supposition_of(text) == meant


@pytest.mark.parametrize("text", ["holding", "holding=true", "=true:0.5", "holding=true:1.5", "a=b:x"])
def test_what_says_no_belief_is_refused_with_an_example(text):
    with pytest.raises(StudyError) as caught:
        supposition_of(text)
    assert caught.value.code == "AOS530"
    assert "holding_can=true:0.5" in caught.value.hint


@pytest.mark.parametrize(
    ("change", "line", "said"),
    [
        ("pick.sd:2=-7.5", "  __reward = -7.5;", "pick.sd:2: -7.5 instead of -2"),
        ("pick.sd:3:16=0.9", "  double p = a-0.9 + 3; // odds", "pick.sd:3: 0.9 instead of 0.5"),
        ("pick.sd:3:22=1e3", "  double p = a-0.5 + 1e3; // odds", "pick.sd:3: 1e3 instead of 3"),
    ],
)
def test_a_number_of_a_line_becomes_another_one(change, line, said):
    files, told = changed_files(FILES, [change])
    assert line in files["pick.sd"].decode().split("\n")
    assert told == (said,)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("pick.sd:3=1", "2 numbers"),
        ("pick.sd:4=1", "has no number there"),
        ("pick.sd:40=1", "no line 40"),
        ("place.sd:1=1", "no file place.sd"),
        ("pick.sd=1", "changes no number"),
        ("pick.sd:2=much", "changes no number"),
    ],
)
def test_what_changes_no_number_is_refused(change, said):
    with pytest.raises(StudyError, match=said):
        changed_files(FILES, [change])
