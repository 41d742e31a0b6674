from typing import Any

import pytest
from places import BUNDLES

from aos_language.load import (
    bundle_digest,
    changed_skills,
    load_bundle,
    load_files,
    merge,
    pushed_project,
    read_bundle_files,
)
from aos_protocol.errors import StorageError
from aos_registry.catalogue import Catalogue


@pytest.fixture
def files() -> dict[str, bytes]:
    return read_bundle_files(BUNDLES / "armadillo-finer")[0]


def test_a_document_replaces_the_one_of_its_kind_and_name_whatever_its_file_is_called(
    files: dict[str, bytes],
):
    new = {"other.ef": files["armadillo.ef"].replace(b"horizon: 10", b"horizon: 12")}
    merged = merge(files, new)
    assert "armadillo.ef" not in merged.files
    project = load_files(merged.files).project
    assert project.environment.horizon == 12


def test_a_file_name_that_another_document_has_is_refused():
    def document(name: str) -> bytes:
        return (
            b'{"PlpMain": {"Project": "p", "Name": "%s", "Type": "PLP"}, "DynamicModel": {}}' % name.encode()
        )

    merged = merge({"skill.json": document("go")}, {"skill.json": document("come")})
    (error,) = merged.diagnostics
    assert (error.code, error.span.file) == ("AOS111", "skill.json")


def test_files_that_are_no_documents_are_not_kept(files: dict[str, bytes]):
    assert "readme.md" not in merge(files, {"readme.md": b"hello"}).files


def test_the_environment_names_the_project_of_a_push(files: dict[str, bytes]):
    files["navigate.am"] = files["navigate.am"].replace(b"armadillo", b"another")
    assert pushed_project(files) == "armadillo"
    assert pushed_project({"readme.md": b""}) == ""


def test_new_and_changed_skills_are_told_apart(files: dict[str, bytes]):
    finer = load_files(files).project
    rough = load_files(files | read_bundle_files(BUNDLES / "armadillo-rough")[0]).project
    assert rough is not None
    assert finer is not None
    assert changed_skills(rough, finer) == ((), ("pick",))
    assert len(changed_skills(None, finer)[0]) == 5


def test_a_changed_environment_is_no_news_of_a_skill_and_is_told(files: dict[str, bytes]):
    before = load_files(files, name="armadillo").project
    files["armadillo.ef"] = files["armadillo.ef"].replace(b"horizon: 10", b"horizon: 9")
    after = load_files(files, name="armadillo").project
    assert before is not None
    assert after is not None
    assert changed_skills(before, after) == ((), ("the environment",))


def test_the_digest_depends_on_names_and_bytes_and_not_on_the_order():
    files = {"a": b"1", "b": b"2"}
    assert bundle_digest(files, ["a", "b"]) == bundle_digest(files, ["b", "a"])
    assert bundle_digest(files, files) != bundle_digest({"a": b"12", "b": b""}, files)


def test_revisions_are_numbered_and_kept(tmp_path, files: dict[str, bytes]):
    path = tmp_path / "catalogue.db"
    catalogue = Catalogue.open(path)
    assert catalogue.current("armadillo") is None
    assert catalogue.store("armadillo", "d1", {"a": b"1"}, ("x",), 10) == 1
    assert catalogue.store("armadillo", "d2", {"a": b"1", "b": b"2"}, ("x", "y"), 20) == 2
    assert catalogue.store("kettle", "d3", {"c": b"3"}, (), 30) == 1
    catalogue.close()
    catalogue = Catalogue.open(path)
    current = catalogue.current("armadillo")
    assert (current.number, current.digest, current.files) == (2, "d2", {"a": b"1", "b": b"2"})
    entries = [(e.project, e.revision, e.stored_ns, e.skills) for e in catalogue.entries()]
    assert entries == [("armadillo", 2, 20, ("x", "y")), ("kettle", 1, 30, ())]
    catalogue.close()


def test_a_revision_that_cannot_be_stored_whole_is_not_stored_at_all(tmp_path):
    catalogue = Catalogue.open(tmp_path / "catalogue.db")
    catalogue.store("p", "d", {"a": b"1"}, (), 1)
    not_bytes: Any = None
    with pytest.raises(TypeError):
        catalogue.store("p", "d2", {"a": b"2", "b": not_bytes}, (), 2)
    current = catalogue.current("p")
    assert (current.number, current.files) == (1, {"a": b"1"})
    catalogue.close()


def test_a_file_that_is_no_catalogue_is_refused_with_its_name(tmp_path):
    path = tmp_path / "catalogue.db"
    path.write_bytes(b"not a database, but long enough to be looked at" * 10)
    with pytest.raises(StorageError, match="catalogue"):
        Catalogue.open(path)


def test_a_folder_that_is_not_there_is_an_error_and_folders_inside_are_left_out(tmp_path):
    loaded = load_bundle(tmp_path / "absent")
    assert [diagnostic.code for diagnostic in loaded.diagnostics] == ["AOS101"]
    (tmp_path / "inner.sd").mkdir()
    (tmp_path / ".hidden.sd").write_text("x")
    files, (remark,) = read_bundle_files(tmp_path)
    assert files == {}
    assert (remark.span.file, remark.is_error) == ("inner.sd", False)
