from pathlib import Path

import pytest
from deploy_files import HEAD, findings

from aos_deploy.deployment.reading import read_deploy_file
from aos_protocol.errors import DeployError


def lines_of(folder: Path, text: str) -> list[int]:
    return [int(found.partition(":")[0]) for found in findings(folder, HEAD + text)]


def test_aliases_that_would_grow_without_end_are_refused_at_their_lines(folder: Path):
    grown = "".join(f"  x{number}: &x{number} [{f'*x{number - 1},' * 9}]\n" for number in range(1, 60))
    assert lines_of(folder, f"adapters:\n  x0: &x0 [1]\n{grown}")[0] == 5
    assert lines_of(folder, "adapters: {x: &x [*x]}\n") == [4, 4]


@pytest.mark.parametrize("nested", ["[" * 100_000, "{a: " * 2000, "[" * 40 + "]" * 40])
def test_what_is_nested_without_end_is_refused_at_its_line(folder: Path, nested):
    (found,) = findings(folder, f"{HEAD}adapters: {nested}\n")
    assert found.startswith("4:")
    assert "AOS104 nested in more than 32" in found


@pytest.mark.parametrize("number", ["0x" + "f" * 6000, "9" * 6000, "-0b1" + "0" * 64, str(2**63)])
def test_a_number_that_no_machine_has_is_refused_at_its_line(folder: Path, number):
    for text in (f"mission: {{step_limit: {number}}}", f"mission: {{set: {{a: {number}}}}}"):
        assert "4:" in findings(folder, f"{HEAD}{text}\n")[0][:2]


def test_a_time_that_no_clock_has_is_refused(folder: Path):
    (found,) = findings(folder, HEAD + "mission: {hold_s: 1e300}\n")
    assert found == "4:19 AOS106 mission.hold_s is 1e+300; it must be a number of at most 1000000000"


@pytest.mark.parametrize("character", ["\\0", "\\e", "\\x7f", "\\x9b", "\\u202e", "\\ud800"])
@pytest.mark.parametrize(
    "text", ['world: "a%sb"', 'runs: "a%sb"', '"a%sb": 1', 'programs: {sim: {command: ["a%sb"]}}']
)
def test_a_text_with_a_character_that_nothing_is_named_by_is_refused_at_its_line(
    folder: Path, text, character
):
    found = findings(folder, HEAD + text % character + "\n")
    assert any(one.startswith("4:") and "cannot have the character" in one for one in found)
    assert all(one.isprintable() for one in found)


def test_a_raw_control_character_is_refused_at_its_line(folder: Path):
    assert findings(folder, HEAD + "runs: a\x1b[2J\n") == [
        "4:0 AOS104 a text cannot have the character U+001B"
    ]


@pytest.mark.parametrize("name", ["x" * 10_000, "x/" * 3000, "loop", "loop/x"])
def test_paths_that_no_file_has_are_no_files(folder: Path, name):
    (folder / "loop").symlink_to("loop")
    of_its_skill = "leave_out: [drive]\n"  # Nobody knows which skills a folder has that is not there.
    (found,) = findings(folder, HEAD.replace("[bundle]", f"[{name}]") + of_its_skill)
    assert "AOS101 there is no bundle folder" in found
    assert len(found) < 400
    assert lines_of(folder, f"world: {name}\nsolver: {{policy: {name}}}\n") == [4, 5]


@pytest.mark.parametrize("expression", ["(" * 5000, "a{99999999999}", "["])
def test_a_line_to_look_for_that_is_no_expression_is_refused(folder: Path, expression):
    part = f"programs: {{sim: {{command: [a], ready: {{line: '{expression}'}}}}}}\n"
    assert lines_of(folder, part) == [4]


def test_a_file_that_has_no_end_is_not_read_on(tmp_path):
    (tmp_path / "rover.yaml").symlink_to("/dev/zero")
    with pytest.raises(DeployError) as caught:
        read_deploy_file(tmp_path / "rover.yaml")
    assert "more than 1000000 bytes" in caught.value.diagnostics[0].message


@pytest.mark.parametrize("name", ["x" * 10_000, "a\0b", "loop"])
def test_a_deploy_file_that_cannot_be_is_not_there(tmp_path, name):
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(DeployError) as caught:
        read_deploy_file(tmp_path / name)
    assert len(str(caught.value)) < 1000
