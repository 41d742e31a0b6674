import pytest
from mistakes import Verdict, judged, mistakes
from places import DATA
from projects import bundle_project
from scripted_models import scripted

RIGHT_COLUMNS = 0.95


@pytest.fixture(scope="module")
def verdicts() -> list[Verdict]:
    return [judged(mistake) for mistake in mistakes()]


def test_there_are_fifteen_mistakes_in_each_of_eight_bundles(verdicts: list[Verdict]):
    assert len(verdicts) == 120


def test_every_mistake_is_told_with_its_code_in_the_right_file_and_line(verdicts: list[Verdict]):
    assert [verdict.mistake.title for verdict in verdicts if not verdict.has_line] == []


def test_nearly_every_mistake_is_told_in_the_right_column(verdicts: list[Verdict]):
    assert sum(verdict.has_column for verdict in verdicts) >= RIGHT_COLUMNS * len(verdicts)


@pytest.mark.parametrize("bundle", ["doors", "fancy", "fetch", "lamp", "tiger"])
def test_the_bundles_emit_compile_and_run(bundle):
    model = scripted(bundle_project(DATA / "bundles" / bundle))
    assert model.walk(1000)["steps"] == 1000
