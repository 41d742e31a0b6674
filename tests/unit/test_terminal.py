"""Progress of long work where standard error is no terminal."""

from __future__ import annotations

import pytest

from aos_deploy import terminal


def test_long_work_tells_a_log_now_and_then_how_far_it_is(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = 0.0
    monkeypatch.setattr(terminal.time, "monotonic", lambda: now_s)
    with terminal.waiting("deciding") as tell:
        for now_s in (1.0, 19.0, 21.0, 30.0, 41.0):
            tell(f"{now_s:.0f} beliefs")
    said = capsys.readouterr()
    assert said.err == "aos: deciding for 21 s: 21 beliefs\naos: deciding for 41 s: 41 beliefs\n"
    assert not said.out
