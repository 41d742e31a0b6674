"""The emitted C++ of our own bundles, byte for byte. `make promote` accepts it as it is now."""

import os
from pathlib import Path

import pytest
from scripted_models import bundle_project

from aos_solver.emission.emit import emit
from aos_solver.emission.lower import lower

GOLDEN = Path(__file__).parent / "cpp"


def test_the_emitted_model_is_the_promoted_one(bundles: Path) -> None:
    program, _ = lower(bundle_project(bundles / "armadillo-finer"))
    assert program is not None
    check(GOLDEN / "armadillo-finer.cpp", emit(program).cpp)


@pytest.mark.parametrize("example", ["kettle-json", "kettle-sdl"])
def test_a_bundle_with_every_block_is_emitted(root: Path, example: str) -> None:
    program, _ = lower(bundle_project(root / "docs" / "examples" / example))
    assert program is not None
    assert "aos_locals.is_full" in emit(program).cpp, "what a real run tells"


def test_emission_gives_the_same_bytes_again(bundles: Path) -> None:
    first, second = (lower(bundle_project(bundles / "armadillo-finer"))[0] for _ in range(2))
    assert first is not None
    assert second is not None
    assert emit(first).cpp == emit(second).cpp


def check(golden: Path, text: str) -> None:
    if os.environ.get("AOS_PROMOTE") == "1":
        golden.write_text(text)
    assert text == golden.read_text(), f"{golden.name} has changed; `make promote` accepts it"
