"""The cost of a push above reading and checking the documents; `pytest -s` prints it."""

import statistics
import time
from pathlib import Path

from test_registry_service import push, running_registry

from aos_language.load import load_files, read_bundle_files
from aos_protocol.keys import Keys
from aos_runtime.bus.bus import Bus

ROUNDS = 20


async def test_twenty_pushes_are_timed_beside_their_checks(
    tmp_path: Path, endpoint: str, bus: Bus, keys: Keys, bundles: Path
):
    files = read_bundle_files(bundles / "armadillo-finer")[0]
    lint_s, push_s = [], []
    async with running_registry(tmp_path / "run", endpoint, bus, keys):
        await push(bus, keys, files)
        for number in range(ROUNDS):
            changed = files | {"pick.sd": files["pick.sd"] + f"// {number}\n".encode()}
            start = time.perf_counter()
            assert not load_files(changed).has_errors
            checked = time.perf_counter()
            assert (await push(bus, keys, changed)).revision == number + 2
            lint_s.append(checked - start)
            push_s.append(time.perf_counter() - checked)
    above_s = statistics.median(push_s) - statistics.median(lint_s)
    print(
        f"check {statistics.median(lint_s) * 1e3:.1f} ms, push {statistics.median(push_s) * 1e3:.1f} ms "
        f"(slowest {max(push_s) * 1e3:.1f} ms), above the check {above_s * 1e3:.1f} ms"
    )
