import pytest
from places import BUNDLES

from aos_language.load import load_files, merge, read_bundle_files
from aos_language.reading.document import is_higher
from aos_protocol.diagnostics import Diagnostic
from aos_registry.catalogue import Catalogue


@pytest.fixture
def files() -> dict[str, bytes]:
    return read_bundle_files(BUNDLES / "armadillo-finer")[0]


def sdl(files: dict[str, bytes], version: str, reward: bytes = b"-2") -> dict[str, bytes]:
    text = files["pick.sd"].replace(b"__reward = -2;", b"__reward = " + reward + b";")
    first, rest = text.split(b"\n", 1)
    return {"pick.sd": b"\n".join([first, b"version: " + version.encode(), rest])}


def skill(version: str, comment: str = "") -> dict[str, bytes]:
    header = f'{{"Project": "p", "Name": "go", "Type": "PLP", "Version": {version}, "Comment": "{comment}"}}'
    return {"go.json": f'{{"PlpMain": {header}, "DynamicModel": {{}}}}'.encode()}


def complaints(stored: dict[str, bytes], new: dict[str, bytes]) -> list[Diagnostic]:
    return list(merge(stored, new).diagnostics)


@pytest.mark.parametrize(
    ("version", "other", "expected"),
    [("1.10", "1.9", True), ("2", "1.9.9", True), ("1.0", "1", False), ("1.2", "1.2.0", False)],
)
def test_versions_are_compared_number_by_number(version, other, expected):
    assert is_higher(version, other) is expected


def test_a_changed_document_needs_a_higher_version_than_the_stored_one(files: dict[str, bytes]):
    stored = files | sdl(files, "1.2")
    (error,) = complaints(stored, sdl(files, "1.2", b"-3"))
    assert (error.code, error.span.file, error.span.line, error.span.column) == ("AOS129", "pick.sd", 2, 10)
    assert error.message == "the skill document pick has changed, and version 1.2 is not above 1.2"
    assert error.hint == "Declare a version above 1.2"
    assert complaints(stored, sdl(files, "1.1", b"-3"))
    assert not complaints(stored, sdl(files, "1.3", b"-3"))


def test_the_same_document_again_is_no_change(files: dict[str, bytes]):
    assert not complaints(files | sdl(files, "1.2"), sdl(files, "1.2"))


def test_a_version_cannot_be_dropped_but_may_be_introduced(files: dict[str, bytes]):
    (error,) = complaints(files | sdl(files, "1.2"), {"pick.sd": files["pick.sd"]})
    assert error.message == "the skill document pick declares no version, the stored one 1.2"
    assert not complaints(files, sdl(files, "0.1"))


def test_documents_without_versions_replace_one_another(files: dict[str, bytes]):
    assert not complaints(files, {"pick.sd": files["pick.sd"] + b"\n"})


def test_in_json_a_version_is_text_and_the_bare_number_of_aos_1_is_none():
    assert complaints(skill('"1.2"'), skill('"1.2"', "new"))
    assert not complaints(skill("1.2"), skill("1.2", "new"))


def test_what_is_no_version_is_a_warning(files: dict[str, bytes]):
    loaded = load_files(files | sdl(files, "new"))
    (warning,) = [finding for finding in loaded.diagnostics if "no version" in finding.message]
    assert (str(warning.span), warning.is_error) == ("pick.sd:2:10", False)


def test_the_history_tells_versions(files: dict[str, bytes], tmp_path):
    loaded = load_files(files | sdl(files, "1.2"))
    catalogue = Catalogue.open(tmp_path / "catalogue.db")
    catalogue.store("armadillo", loaded.digest, {"pick.sd": b"", "a.ef": b""}, (), 1, loaded.versions)
    (entry,) = catalogue.history("armadillo")
    catalogue.close()
    assert entry.versions == {"pick.sd": "1.2"}
