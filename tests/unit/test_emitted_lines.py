import re

import pytest
from places import BUNDLES
from projects import bundle_project, text_project
from scripted_models import lowered

from aos_solver.emission.emit import EmittedModel
from aos_solver.emission.lowering.lower import lower

MAX_COLUMNS = 110

LANGUAGE = re.compile(
    r"__(reward|moduleResponse|moduleResponseStr|moduleExecutionTime|meetPrecondition|heuristicValue|isGoalState"
    r"|isFailureState|stopEvaluatingState|possibleParameters|observed)"
)
"""The names that the documents' language gives; they begin with two underscores."""


def own_lines(emitted: EmittedModel) -> list[str]:
    lines = enumerate(emitted.cpp.split("\n"), 1)
    return [line for number, line in lines if number not in emitted.origins and not line.startswith("#line")]


@pytest.mark.parametrize("name", ["armadillo-finer", "bench/tag", "bench/rocksample-7-8", "bench/pocman"])
def test_lines_are_narrow_and_names_are_none_of_the_compilers(name):
    own = own_lines(lowered(bundle_project(BUNDLES / name))[0])
    assert [line for line in own if len(line) > MAX_COLUMNS] == []
    reserved = {found for line in own for found in re.findall(r"(?<!\w)_[_A-Z]\w*|\b[A-Za-z]\w*__\w+", line)}
    assert {name for name in reserved if not LANGUAGE.fullmatch(name)} == set()


def test_long_lists_go_on_in_the_next_line():
    values = ", ".join(f"place_number_{number}" for number in range(40))
    home = (
        f"project: test\nhorizon: 3\ndefine_type: Place\nenum_members: {values}\nstate_variable: Place at\n"
    )
    act = "project: test\ndynamic_model:\nstate__.at = place_number_7;\n"
    project = text_project({"home.ef": home, "act.sd": act})
    own = own_lines(lowered(project)[0])
    assert max(map(len, own)) <= MAX_COLUMNS
    assert sum("place_number_39" in line for line in own) >= 1


def test_names_of_the_emitted_model_are_no_names_of_documents():
    home = "project: test\nhorizon: 3\nstate_variable: int aos_ending\n"
    act = "project: test\ndynamic_model:\nstate__.aos_ending = 1;\n"
    project = text_project({"home.ef": home, "act.sd": act})
    _, findings = lower(project)
    assert "the emitted model uses the name `aos_ending`" in [finding.message for finding in findings]
