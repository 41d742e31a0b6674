"""The emitted C++ of a bundle that has every block, byte for byte. `make promote` accepts it as it is now."""

from places import BUNDLES, ROOT
import os
from pathlib import Path

import pytest
from projects import bundle_project

from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower

GOLDEN = Path(__file__).parent


@pytest.mark.parametrize("example", ["kettle-json", "kettle-sdl"])
def test_the_emitted_model_of_every_block_is_the_promoted_one(example):
    program, _ = lower(bundle_project(ROOT / "docs" / "examples" / example))
    assert program is not None
    cpp = emit(program).cpp
    assert "aos_locals.is_full" in cpp, "what a real run tells"
    if example == "kettle-sdl":
        check(GOLDEN / "kettle.cpp", cpp)


def test_emission_gives_the_same_bytes_again():
    first, second = (lower(bundle_project(BUNDLES / "armadillo-finer"))[0] for _ in range(2))
    assert first is not None
    assert second is not None
    assert emit(first).cpp == emit(second).cpp


def check(golden: Path, text: str):
    if os.environ.get("AOS_PROMOTE") == "1":
        golden.write_text(text)
    assert text == golden.read_text(), f"{golden.name} has changed; `make promote` accepts it"
