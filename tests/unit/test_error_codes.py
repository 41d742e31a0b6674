import re
from pathlib import Path

import msgspec
import numpy as np
import pytest
from places import ROOT
from test_reading_rules import REFUSED, WARNED, WHOLE_FILES

from aos_deploy.runs.directory import RunDirectory
from aos_language.load import load_files
from aos_protocol.codec import open_envelope
from aos_protocol.errors import CODES, AosError, BusError, DeployError, PlanningError
from aos_protocol.messages import Envelope
from aos_solver.offline.explicit_model import ExplicitModel, Ragged
from aos_solver.offline.solving import SolvingLimits, solve


def test_a_bundle_beyond_the_limits_is_refused():
    loaded = load_files({"folder/go.sd": b"project: p\n"})
    assert "AOS120" in {finding.code for finding in loaded.diagnostics}


def test_a_message_of_another_protocol_is_refused():
    payload = msgspec.msgpack.encode(Envelope("9.0", 1, "somebody", msgspec.Raw(b"\x80")))
    with pytest.raises(BusError, match=r"speaks protocol 9\.0") as caught:
        open_envelope(payload)
    assert caught.value.code == "AOS603"


async def test_a_problem_that_is_over_at_the_start_is_not_solved(tmp_path):
    nothing = Ragged(np.zeros(2, np.int64), np.zeros(0, np.int64), np.zeros(0))
    over = ExplicitModel(
        name="over", discount=0.9, states=("end",), actions=("wait",), observations=("none",),
        rewards=np.zeros((1, 1)), outcomes=nothing, sensings=np.zeros(0, np.int64), likelihoods=nothing,
        starts=(),
    )  # fmt: skip
    with pytest.raises(PlanningError, match="over at the start") as caught:
        await solve(over, SolvingLimits(), cache_dir=tmp_path)
    assert caught.value.code == "AOS302"


def test_runs_that_cannot_be_written_are_told(tmp_path):
    (tmp_path / "runs").write_text("a file where a folder should be")
    with pytest.raises(DeployError, match="no run directory") as caught:
        RunDirectory.create(tmp_path / "runs", "robot", now_ns=0)
    assert caught.value.code == "AOS805"


def test_no_code_of_the_table_is_left_without_a_provocation():
    provoked = {rule.code for rule in (*WARNED, *REFUSED)}
    provoked |= {whole.code for whole in WHOLE_FILES} | {"AOS120", "AOS302", "AOS603", "AOS805"}
    this_file = Path(__file__)
    files = ("**/*.py", "data/mistakes.toml", "golden/documents/*.txt")
    for path in (path for pattern in files for path in (ROOT / "tests").glob(pattern)):
        if path != this_file:
            provoked |= set(re.findall(r"\bAOS\d{3}\b", path.read_text(encoding="utf-8")))
    assert sorted(CODES.keys() - provoked) == []


def test_a_question_ends_a_message_as_a_full_stop_does():
    assert str(AosError("no field; did you mean it?", code="AOS401", hint="Mend it")).endswith("it? Mend it")
    assert str(AosError("no field.", code="AOS401", hint="Mend it")) == "AOS401: no field. Mend it"
