import asyncio
import gzip
import io
import lzma
import random
import tarfile
import zipfile
from collections.abc import AsyncIterator
from functools import partial
from pathlib import Path

import pytest
import pytest_asyncio
from processes import HANG_S
from test_registry_service import current, push, running_registry

from aos_language.archive import read_archive
from aos_protocol.errors import AosError
from aos_protocol.keys import Keys
from aos_protocol.messages import BundleReport
from aos_runtime.bus.bus import Bus
from aos_runtime.processes.children import Child

SEED = 20261121
HOSTILE_PUSHES = 300
HOSTILE_ARCHIVES = 400
DROPPED_ARCHIVES = 60
REFUSAL_CODES = ("AOS101", "AOS120")
COMPRESSIONS = {"tar": bytes, "tar.gz": partial(gzip.compress, mtime=0), "tar.xz": lzma.compress}


@pytest_asyncio.fixture
async def registry(tmp_path, endpoint: str, bus: Bus, keys: Keys) -> AsyncIterator[tuple[Path, Child]]:
    async with running_registry(tmp_path / "run", endpoint, bus, keys) as child:
        yield tmp_path / "run", child


def mutated(data: bytes, chance: random.Random) -> bytes:
    raw = bytearray(data)
    for _ in range(chance.randint(1, 8)):
        start = chance.randrange(len(raw) + 1)
        end = min(len(raw), start + chance.choice((1, 2, 8, 64, 512)))
        piece = chance.choice((
            b"",
            bytes(chance.randrange(256) for _ in range(end - start)),
            bytes(raw[start:end]) * 3,
            b"\xff\xff\xff\xff",
            b"\x00" * (end - start),
            chance.choice((b"{" * 3000, b"[" * 3000, b"(" * 3000, b'"', b"\n//", b"project: \n")),
        ))  # fmt: skip
        raw[start:end] = piece
    return bytes(raw)


def hostile_name(name: str, chance: random.Random) -> str:
    odd = (
        "../" + name,
        "/" + name,
        "a/" + name,
        name + "\0",
        "",
        "." + name,
        name * 90,
        "a\\" + name,
        "\u202e.sd",
    )
    return chance.choice(odd) if chance.random() < 0.2 else name


def tar_of(files: dict[str, bytes], chance: random.Random) -> bytes:
    kinds = (tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.CHRTYPE, tarfile.FIFOTYPE, tarfile.GNUTYPE_SPARSE)
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w") as archive:
        for name, data in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(data)
            if chance.random() < 0.05:
                member.type, member.linkname, member.size = chance.choice(kinds), "/etc/passwd", 0
            if chance.random() < 0.05:
                member.pax_headers = {"size": "-1000", "GNU.sparse.map": "1,2,x", "path": "../../x"}
            archive.addfile(member, io.BytesIO(data[: member.size]))
    return buffer.getvalue()


def zip_of(files: dict[str, bytes], chance: random.Random) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", chance.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))) as archive:
        for name, data in files.items():
            member = zipfile.ZipInfo(name)
            member.external_attr = chance.choice((0o100644, 0o120777, 0o020666, 0)) << 16
            archive.writestr(member, data)
    return buffer.getvalue()


def hostile_archive(files: dict[str, bytes], chance: random.Random) -> tuple[str, bytes]:
    chosen = {hostile_name(name, chance): data for name, data in files.items()}
    form = chance.choice(("tar", "tar.gz", "zip", "tar.xz"))
    if form == "zip":
        data = zip_of({name: data for name, data in chosen.items() if name}, chance)
    else:
        data = COMPRESSIONS[form](tar_of(chosen, chance))
    return form, mutated(data, chance) if chance.random() < 0.7 else data


async def test_hostile_pushes_are_answered_and_change_nothing_that_is_not_sound(
    registry: tuple[Path, Child], bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    chance = random.Random(SEED)
    await push(bus, keys, finer)
    for _ in range(HOSTILE_PUSHES):
        name = chance.choice(sorted(finer))
        files = {hostile_name(name, chance): mutated(finer[name], chance)}
        try:
            report = await push(bus, keys, files)
        except AosError as error:
            pytest.fail(f"{files} is answered by {error}")
        assert report.is_accepted or any(finding.is_error for finding in report.diagnostics)
    assert (await current(bus, keys)).project.name == "armadillo"
    assert registry[1].returncode is None


async def test_dropped_hostile_archives_do_not_take_the_registry_down(
    registry: tuple[Path, Child], bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    run_dir, child = registry
    chance = random.Random(SEED)
    async with asyncio.timeout(HANG_S), bus.listen(keys.bundle_report, BundleReport) as reports:
        for number in range(DROPPED_ARCHIVES):
            form, data = hostile_archive(finer, chance)
            (run_dir / "drop" / f"{number:03}.{form}").write_bytes(data)
        (run_dir / "drop" / "zz").mkdir()
        for name, data in finer.items():
            (run_dir / "drop" / "zz" / name).write_bytes(data)
        async for _, report in reports:
            if report.source == "zz":
                assert report.is_accepted
                break
    assert child.returncode is None
    assert not list(run_dir.parent.glob("*.sd"))


def test_hostile_archives_are_read_or_refused(finer: dict[str, bytes], tmp_path):
    chance = random.Random(SEED)
    refused = 0
    for number in range(HOSTILE_ARCHIVES):
        form, data = hostile_archive(finer, chance)
        path = tmp_path / f"{number}.{form}"
        path.write_bytes(data)
        files, remarks = read_archive(path)
        errors = [remark for remark in remarks if remark.is_error]
        assert not (errors and files)
        assert {error.code for error in errors} <= set(REFUSAL_CODES)
        refused += bool(errors)
        path.unlink()
    assert refused > HOSTILE_ARCHIVES / 3
    assert list(tmp_path.iterdir()) == []
