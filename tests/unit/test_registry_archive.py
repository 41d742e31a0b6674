import io
import shutil
import tarfile
import zipfile
from pathlib import Path

import pytest
from places import BUNDLES

from aos_language.archive import read_archive
from aos_language.load import load_bundle, read_bundle_files
from aos_language.reading.files import MAX_BUNDLE_BYTES


def tar_of(path: Path, *members: tuple[tarfile.TarInfo, bytes]) -> Path:
    with tarfile.open(path, "w:gz") as archive:
        for member, data in members:
            member.size = len(data)
            archive.addfile(member, io.BytesIO(data))
    return path


def file(name: str, data: bytes = b"project: p\n") -> tuple[tarfile.TarInfo, bytes]:
    return tarfile.TarInfo(name), data


def link(name: str, target: str, kind: bytes = tarfile.SYMTYPE) -> tuple[tarfile.TarInfo, bytes]:
    member = tarfile.TarInfo(name)
    member.type, member.linkname = kind, target
    return member, b""


def refusal(path: Path) -> str:
    files, (diagnostic,) = read_archive(path)
    assert not files
    assert diagnostic.is_error
    assert diagnostic.span.file == path.name
    return diagnostic.message


@pytest.mark.parametrize("form", ["tar", "gztar", "bztar", "xztar", "zip"])
@pytest.mark.parametrize("is_folder_packed", [True, False])
def test_a_packed_bundle_is_the_same_as_its_directory(tmp_path, form, is_folder_packed):
    bundle = BUNDLES / "armadillo-finer"
    base = {"root_dir": BUNDLES, "base_dir": bundle.name} if is_folder_packed else {"root_dir": bundle}
    path = Path(shutil.make_archive(str(tmp_path / "packed"), form, **base))
    assert read_bundle_files(path) == read_bundle_files(bundle)
    assert load_bundle(path).digest == load_bundle(bundle).digest


@pytest.mark.parametrize("name", ["../out.sd", "/etc/out.sd", "a/../../out.sd", "a\\out.sd"])
def test_an_entry_that_leads_out_is_refused(tmp_path, name):
    assert refusal(tar_of(tmp_path / "b.tgz", file(name))) == f"the entry {name!r} leads out of the archive"
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr(name, "project: p")
    assert "leads out" in refusal(tmp_path / "b.zip")


@pytest.mark.parametrize(
    ("kind", "name"), [(tarfile.SYMTYPE, "link"), (tarfile.LNKTYPE, "link"), (tarfile.CHRTYPE, "device")]
)
def test_a_link_and_a_device_are_refused(tmp_path, kind, name):
    path = tar_of(tmp_path / "b.tgz", link("a.sd", "/etc/passwd", kind))
    assert refusal(path) == f"the entry 'a.sd' is a {name}"


def test_a_link_in_a_zip_file_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        member = zipfile.ZipInfo("a.sd")
        member.external_attr = 0o120777 << 16
        archive.writestr(member, "/etc/passwd")
    assert refusal(tmp_path / "b.zip") == "the entry 'a.sd' is a link"


def test_too_large_an_entry_is_refused_before_it_is_unpacked(tmp_path):
    zeros = bytes(MAX_BUNDLE_BYTES + 1)
    path = tar_of(tmp_path / "b.tgz", file("a.sd", zeros))
    assert path.stat().st_size < 20_000
    assert f"has {len(zeros)} bytes" in refusal(path)


def test_too_much_in_all_is_refused(tmp_path):
    half = bytes(MAX_BUNDLE_BYTES // 2 + 1)
    with zipfile.ZipFile(tmp_path / "b.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.sd", half)
        archive.writestr("b.sd", half)
    assert "bytes of documents" in refusal(tmp_path / "b.zip")


def test_too_many_entries_are_refused(tmp_path):
    assert "entries" in refusal(tar_of(tmp_path / "b.tgz", *(file(f"{n}.sd") for n in range(1001))))


def test_two_bundles_in_one_archive_are_refused(tmp_path):
    path = tar_of(tmp_path / "b.tgz", file("one/a.sd"), file("two/b.sd"))
    assert refusal(path) == "documents in several folders: one, two"


@pytest.mark.parametrize("data", [b"", b"no archive", b"PK\x03\x04 broken", b"\x1f\x8b\x08 broken"])
@pytest.mark.parametrize("name", ["b.tar", "b.tar.gz", "b.zip", "b.tar.xz"])
def test_what_is_no_archive_is_said_to_be_none(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    assert refusal(tmp_path / name).startswith("the archive cannot be read: ")


def test_an_archive_that_was_cut_anywhere_is_refused(tmp_path):
    bundle = BUNDLES / "armadillo-retract"
    whole = Path(shutil.make_archive(str(tmp_path / "whole"), "tar", bundle)).read_bytes()
    end = len(whole.rstrip(b"\0")) // tarfile.BLOCKSIZE * tarfile.BLOCKSIZE + tarfile.BLOCKSIZE
    for size in range(0, end + 1, 128):
        (tmp_path / "b.tar").write_bytes(whole[:size])
        assert refusal(tmp_path / "b.tar").startswith("the archive cannot be read: ")


def test_other_files_and_hidden_ones_are_left_out(tmp_path):
    files, remarks = read_archive(tar_of(tmp_path / "b.tgz", file("a.sd"), file("README.md"), file(".b.sd")))
    assert list(files) == ["a.sd"]
    assert [remark.span.file for remark in remarks] == ["README.md"]
