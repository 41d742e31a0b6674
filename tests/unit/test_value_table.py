"""The table of the actions' values."""

from __future__ import annotations

import math

import pytest

from aos_deploy.views.tables import print_values
from aos_protocol.messages import ActionValue


def test_what_a_policy_never_chooses_has_a_dash_for_its_value(capsys: pytest.CaptureFixture[str]) -> None:
    values = [ActionValue("open", 2.5, 0, 0.0), ActionValue("wait", -math.inf, 0, 0.0)]
    print_values(values, 0, "the policy")
    table = capsys.readouterr().out
    assert "+2.500" in table
    assert "inf" not in table
    assert "wait" in table
