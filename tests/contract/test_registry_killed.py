import asyncio
import os
import random
import signal
from pathlib import Path

import pytest
from test_registry_service import current, push, running_registry

from aos_language.load import bundle_digest
from aos_protocol.keys import Keys
from aos_protocol.messages import BundleReport
from aos_registry.catalogue import Catalogue, Revision
from aos_runtime.bus.bus import Bus

pytestmark = pytest.mark.slow

SEED = 20261121
KILLS = 12
PUSHES_BEFORE_KILL = 4
"""The number of pushes that are accepted at most before the moment of the kill is drawn."""
LATEST_KILL_S = 0.1
POLL_S = 0.005

Accepted = dict[int, bytes]
"""The content of pick.sd in each accepted revision."""


async def push_on(bus: Bus, keys: Keys, pick: bytes, accepted: Accepted):
    while True:
        document = pick + f"// {os.urandom(8).hex()}\n".encode()
        report: BundleReport = await push(bus, keys, {"pick.sd": document})
        assert report.is_accepted
        accepted[report.revision] = document


def stored_revisions(path: Path) -> list[Revision]:
    catalogue = Catalogue.open(path)
    found = [catalogue.revision("armadillo", entry.revision) for entry in catalogue.history("armadillo")]
    catalogue.close()
    return [revision for revision in found if revision is not None]


async def test_sigkill_at_any_moment_loses_no_accepted_push_and_leaves_no_half(
    tmp_path, endpoint: str, bus: Bus, keys: Keys, finer: dict[str, bytes]
):
    chance = random.Random(SEED)
    run_dir = tmp_path / "run"
    accepted: Accepted = {}
    async with running_registry(run_dir, endpoint, bus, keys):
        await push(bus, keys, finer)
    for _ in range(KILLS):
        async with running_registry(run_dir, endpoint, bus, keys) as child:
            assert (await current(bus, keys)).revision == len(stored_revisions(run_dir / "catalogue.db"))
            pushing = asyncio.ensure_future(push_on(bus, keys, finer["pick.sd"], accepted))
            enough = len(accepted) + chance.randint(0, PUSHES_BEFORE_KILL)
            while len(accepted) < enough and not pushing.done():
                await asyncio.wait({pushing}, timeout=POLL_S)
            await asyncio.wait({pushing}, timeout=chance.uniform(0.0, LATEST_KILL_S))
            os.kill(child.pid, signal.SIGKILL)
            await asyncio.gather(pushing, return_exceptions=True)
            assert not isinstance(pushing.exception(), AssertionError)
        revisions = stored_revisions(run_dir / "catalogue.db")
        assert [revision.number for revision in revisions] == list(range(1, len(revisions) + 1))
        assert max(accepted, default=1) <= len(revisions)
        for revision in revisions:
            assert revision.digest == bundle_digest(revision.files, revision.files)
            assert set(revision.files) == set(finer)
            assert revision.files["pick.sd"] == accepted.get(revision.number, revision.files["pick.sd"])
    assert len(accepted) > KILLS
    print(f"{KILLS} kills, {len(accepted)} accepted pushes, 0 lost")
