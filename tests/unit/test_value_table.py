import math

import msgspec
import pytest

from aos_deploy.views.tables import print_runs, print_values
from aos_deploy.views.values import Digits
from aos_protocol.chances import chance_text
from aos_protocol.messages import ActionValue
from aos_solver.mission.rules.endings import Ending
from aos_solver.mission.simulation import SimulatedRun


def test_what_a_policy_never_chooses_has_a_dash_for_its_value(capsys):
    values = [ActionValue("open", 2.5, 0, 0.0), ActionValue("wait", -math.inf, 0, 0.0)]
    print_values(values, 0, "the policy")
    table = capsys.readouterr().out
    assert "+2.500" in table
    assert "inf" not in table
    assert "wait" in table


@pytest.mark.parametrize(("number", "shown"), [(13, 13), (14, 12), (389, 12)])
def test_of_many_actions_the_best_are_shown_and_the_others_counted(number, shown, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    values = [ActionValue(f"go(to=place_{place})", -place, 10, 0.1) for place in range(number)]
    print_values(list(reversed(values)), 30, "", shows_all=False)
    told = capsys.readouterr().out
    rows = [line.split()[1] for line in told.splitlines() if "go(" in line]
    assert rows == [value.action for value in values[:shown]]
    line = f"{number - 12} more actions, worth -12.000 at most; `--all` and `--json` have them"
    assert (line in told) == (number > shown)
    print_values(values, 30, "")
    assert capsys.readouterr().out.count("go(") == number


def test_what_is_proven_of_values_is_rounded_outwards(capsys):
    values = [
        ActionValue("open", 2.5, 10, 0.1, -1.00004, 3.00004),
        ActionValue("wait", 0.25, 10, 0.1, 0.25 - 1e-12, 0.25 + 1e-12),
        ActionValue("leave", 0.0, 10, 0.1),
    ]
    print_values(values, 30, "")
    rows = {line.split()[1]: line.split("│") for line in capsys.readouterr().out.splitlines() if "│" in line}
    assert [cell.strip() for cell in rows["open"][5:7]] == ["-1.001", "+3.001"]
    assert [cell.strip() for cell in rows["wait"][5:7]] == ["+0.250", "+0.250"]
    assert [cell.strip() for cell in rows["leave"][5:7]] == ["", ""]


@pytest.mark.parametrize("columns", ["30", "40", "60"])
def test_a_narrow_terminal_cuts_no_value(columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    print_values([ActionValue("take(side=right_side)", -14.798, 1, 0.0)], 30, "")
    table = capsys.readouterr().out
    assert "-14.798" in table
    assert "…" not in table
    assert all(len(line) <= int(columns) for line in table.splitlines())


@pytest.mark.parametrize("columns", ["40", "50", "100"])
def test_what_missions_did_stands_below_a_narrow_table(columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    run = SimulatedRun(7, -1.0, -1.0, Ending.STEP_LIMIT, 1, ("listen",), ("tiger_left",))
    print_runs([run], {"runs": 1, "mean_discounted_return": -1, "mean_steps": 1}, has_goals=False)
    lines = capsys.readouterr().out.splitlines()
    assert any("step_limit" in line and "-1.0" in line for line in lines)
    assert ("seed world mission steps return" in lines) == (columns == "40")
    assert ("7: listen → tiger_left" in lines) == (columns != "100")
    assert sum("listen → tiger_left" in line for line in lines) == 1


def test_small_values_are_told_in_digits_of_their_size(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    values = [
        ActionValue("open", 2.5e-6, 10, 1e-8, 2.4999996e-6, 2.5e-6),
        ActionValue("wait", -1.25e-6, 10, 0.0),
    ]
    print_values(values, 30, "")
    run = SimulatedRun(7, -4e-6, -4e-6, Ending.STEP_LIMIT, 1, ("listen",), ("tiger_left",))
    summary = {"runs": 2, "mean_discounted_return": -4e-6, "stderr": 2e-7, "mean_steps": 1}
    print_runs([run], summary, has_goals=False)
    told = capsys.readouterr().out
    for text in ("+0.000002500", "0.000000010", "+0.000002499", "-0.000001250", " -0.0000040 "):
        assert text in told
    assert "discounted return -0.00000400 ± 0.00000020" in told
    assert "│ ██" in told


def test_the_summary_of_missions_says_how_the_others_ended(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    endings = [Ending.GOAL, Ending.OVER, Ending.STEP_LIMIT, Ending.STEP_LIMIT]
    runs = [SimulatedRun(seed, 1.0, 1.0, ending, 1, (), ()) for seed, ending in enumerate(endings)]
    runs[1] = msgspec.structs.replace(runs[1], world_ending=Ending.OVER)
    rates = dict.fromkeys(("goal_rate", "believed_goal_rate", "failure_rate"), 0.25)
    print_runs(runs, {"runs": 4, "mean_discounted_return": 1, "mean_steps": 1} | rates)
    told = capsys.readouterr().out
    assert "failure in 25%, step_limit in 50%, over in 25%, discounted" in told
    assert "believed in 25% (25% ended with the world, unnoticed), " in told


@pytest.mark.parametrize(
    ("probability", "text"),
    [(0.0, "0.000"), (1e-7, "<0.001"), (0.5, "0.500"), (0.9999, ">0.999"), (1 - 1e-15, "1.000")],
)
def test_what_is_not_certain_is_never_shown_as_certain(probability, text):
    assert chance_text(probability) == text


@pytest.mark.parametrize(
    ("values", "usual", "texts"),
    [
        ([11.25, -0.0004], 2, ["+11.25", "-0.00"]),
        ([0.5], 3, ["+0.5000"]),
        ([123456.78], 3, ["+123456.8"]),
        ([1e-13, math.inf], 2, ["+1.00e-13", "-"]),
        ([5e-324], 2, ["+4.94e-324"]),
        ([0.0], 2, ["+0.00"]),
    ],
)
def test_numbers_that_are_printed_together_have_the_digits_of_the_largest(values, usual, texts):
    assert [Digits.of(values, usual).signed(value) for value in values] == texts
