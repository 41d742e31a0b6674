import io
import threading

import pytest

from aos_deploy import terminal, timed_lines


def test_long_work_tells_a_log_now_and_then_how_far_it_is(capsys, monkeypatch):
    now_s = 0.0
    monkeypatch.setattr("time.monotonic", lambda: now_s)
    with terminal.waiting("deciding") as tell:
        for now_s in (1.0, 19.0, 21.0, 30.0, 41.0):
            tell(f"{now_s:.0f} beliefs")
    said = capsys.readouterr()
    assert said.err == "aos: deciding for 21 s: 21 beliefs\naos: deciding for 41 s: 41 beliefs\n"
    assert not said.out


def test_counted_work_tells_a_log_now_and_then_how_much_is_done(capsys, monkeypatch):
    monkeypatch.setattr(timed_lines, "LINE_EVERY_S", 0.0)
    with terminal.progress() as bar:
        task = bar.add_task("hard-table", total=10)
        bar.advance(task)
        bar.update(task, description="easy-table", completed=4)
    begun, first, second = capsys.readouterr().err.splitlines()
    assert begun == "aos: working for 0 s: hard-table: 0 of 10"
    assert first == "aos: working for 0 s: hard-table: 1 of 10"
    assert second == "aos: working for 0 s: easy-table: 4 of 10"


class Log(io.StringIO):
    """A standard error that lets somebody wait for a first line."""

    def __init__(self):
        super().__init__()
        self.has_a_line = threading.Event()

    def flush(self):
        super().flush()
        self.has_a_line.set()


def test_work_that_tells_nothing_is_told_of_all_the_same(monkeypatch):
    log = Log()
    monkeypatch.setattr("sys.stderr", log)
    monkeypatch.setattr(timed_lines, "TICK_S", 0.01)
    with terminal.waiting("looking", first_s=0.02):
        assert log.has_a_line.wait(30)
    assert log.getvalue() == "aos: looking for 0 s\n"


@pytest.mark.parametrize(
    ("encoding", "written"),
    [("latin-1", b"\xe9 ??"), ("ascii", b"? ??"), ("utf-8", b"\xc3\xa9 \xe2\x94\x83\\udcff")],
)
@pytest.mark.parametrize("errors", ["strict", "surrogateescape"])
def test_what_an_output_cannot_write_does_not_end_the_command(encoding, written, errors):
    """Python escapes surrogates where the locale is C."""
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding=encoding, errors=errors)
    terminal.write_what_fits(stream)
    stream.write("\u00e9 \u2503\udcff")
    stream.flush()
    assert raw.getvalue() == written
