import math

import pytest

from aos_deploy.views.tables import print_runs, print_values
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


@pytest.mark.parametrize("columns", ["50", "100"])
def test_what_missions_did_stands_below_a_narrow_table(columns, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    run = SimulatedRun(7, -1.0, -1.0, Ending.STEP_LIMIT, 1, ("listen",), ("tiger_left",))
    print_runs([run], {"runs": 1, "mean_discounted_return": -1, "mean_steps": 1}, has_goals=False)
    lines = capsys.readouterr().out.splitlines()
    assert any("step_limit" in line and "-1.0" in line for line in lines)
    assert ("7: listen → tiger_left" in lines) == (columns == "50")
    assert sum("listen → tiger_left" in line for line in lines) == 1
