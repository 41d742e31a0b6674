from aos_deploy.processes.ready import _Printed
from aos_deploy.processes.start import shorten


def test_a_log_that_is_too_long_is_cut_to_its_end_and_its_writer_goes_on(tmp_path):
    log = tmp_path / "arm.log"
    with log.open("ab", buffering=0) as writer:
        for number in range(1000):
            writer.write(b"line %d\n" % number)
        size = log.stat().st_size
        shorten(log, most_bytes=size, kept_bytes=100)
        assert log.stat().st_size == size
        shorten(log, most_bytes=size - 1, kept_bytes=100)
        writer.write(b"the next line\n")
    first, *others = log.read_text().splitlines()
    assert first == f"aos-up: this log had {size} bytes, and was cut to its end"
    assert others == [*(f"line {number}" for number in range(989, 1000)), "the next line"]


def test_a_line_that_says_that_a_program_is_ready_is_seen_in_a_log_that_was_cut(tmp_path):
    log = tmp_path / "arm.log"
    log.write_text("noise\n" * 100)
    lines = _Printed(log, 0, "^ready$")
    assert not lines.has_line()
    shorten(log, most_bytes=10, kept_bytes=10)
    with log.open("a") as writer:
        writer.write("ready\n")
    assert lines.has_line()
