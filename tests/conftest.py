import gc
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from kept_cache import kept_cache
from places import ROOT

from aos_runtime.sandbox.support import sandbox_support, sandbox_text, trust_documents

TESTS = ROOT / "tests"
LONGEST = TESTS / "longest_first.txt"
"""Files of tests, by the processor time that docs/lab/checks.md tells of."""


def pytest_configure() -> None:
    """The documents of tests are ours, and Ctrl-C is heard.

    Where the kernel can confine documents, nothing takes it back. A script that starts the tests in the
    background leaves them a Ctrl-C that is ignored: tests that interrupt a command would wait for ever.
    """
    if not sandbox_support().is_whole:
        trust_documents()
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    gc.disable()  # Collecting tests leaves no garbage, in any of the processes that do so.


def pytest_report_header() -> str:
    """Says at the head of a run what the tests' documents run in."""
    return f"sandbox: {sandbox_text()}"


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The original AOS bundles, third-party data beside the checkout; tests skip where it is absent."""
    folder = ROOT.parent / "shared" / "corpus"
    if not folder.is_dir():
        pytest.skip("needs the original AOS bundles in ../shared/corpus, which are not part of this project")
    return folder


@pytest.fixture(scope="session", autouse=True)
def cache_dir(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Compiled models kept from run to run, with the engines of setup.sh. Commands use them, too.

    Commands find the missions that run in this process of the tests, and those of no other.
    """
    folder = kept_cache()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("AOS_CACHE_DIR", str(folder))
        patch.setenv("AOS_RUNNING_DIR", str(tmp_path_factory.mktemp("running")))
        yield folder


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Puts the files that take longest first, so that processes that share the tests end together."""
    places = {name: place for place, name in enumerate(LONGEST.read_text().split())}
    items.sort(key=lambda item: places.get(item.path.relative_to(TESTS).as_posix(), len(places)))


def pytest_collection_finish() -> None:
    """Sets apart from garbage what stays for the whole run: thousands of tests."""
    gc.collect()
    gc.freeze()
    gc.enable()
