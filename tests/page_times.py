"""Times of the page: `python -m tests.page_times`, or `--decisions 100 --viewers 10`.

A mission whose robot waits for turns is viewed by several browsers. A decision is on the screen when the
page has drawn its step. Then a mission of 1,000 steps is loaded anew, some times.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from gateway import Gateway, gateway, slow_system
from long_run import write_long_run
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / ".compiled"
OBSERVE = """() => {
  window.seen = {};
  const look = () => {
    const text = document.querySelector(".stepper-place b")?.textContent;
    if (text && !(text in window.seen)) requestAnimationFrame(() => (window.seen[text] ??= Date.now()));
  };
  new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
  look();
}"""


def viewed(browser: Browser, served: Gateway, mission: str) -> Page:
    page = browser.new_context(bypass_csp=True, viewport={"width": 1440, "height": 900}).new_page()
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{mission}")
    page.wait_for_function("document.querySelector('.connection')?.textContent === 'Live'")
    page.evaluate(OBSERVE)
    return page


def decisions(browser: Browser, folder: Path, number: int, viewers: int) -> list[float]:
    """The milliseconds from each decision until it is on each screen."""
    with slow_system(folder, CACHE) as run, gateway(folder, CACHE) as served:
        pages = [viewed(browser, served, run.name) for _ in range(viewers)]
        for step in range(2, number + 2):
            (folder / "turns").write_bytes(b".")
            for page in pages:
                page.wait_for_function("step => String(step) in window.seen", arg=step)
        records = {}
        since = 0
        while page_of := served.ask(f"/v1/missions/{run.name}/decisions?since={since}").json["records"]:
            records |= {each["step"]: each["stamp_ns"] / 1e6 for each in page_of if "outcome" not in each}
            since = page_of[-1]["sequence"] + 1
        seen = [page.evaluate("window.seen") for page in pages]
    return [times[str(step)] - records[step] for times in seen for step in range(2, number + 2)]


def reloads(browser: Browser, folder: Path, times: int) -> tuple[list[float], int]:
    """The milliseconds until 1,000 steps are drawn after a reload, and the bytes that came."""
    name = write_long_run(folder / "runs", 1000)
    with gateway(folder, CACHE) as served:
        page = browser.new_context(bypass_csp=True, viewport={"width": 1440, "height": 900}).new_page()
        page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}")
        taken = []
        size = 0
        for _ in range(times):
            page.reload(wait_until="commit")
            drawn = (
                "document.querySelector('.stepper-place')?.textContent === '1000 of 1000'"
                " && document.querySelectorAll('.ribbon').length === 8"
                " && !document.querySelector('[aria-busy=true]') && performance.now()"
            )
            taken.append(float(page.wait_for_function(drawn, polling="raf").json_value()))
            sizes = (
                "performance.getEntriesByType('resource').reduce((sum, each) => sum + each.transferSize, 0)"
            )
            size = max(size, int(page.evaluate(sizes)))
    return taken, size


def main() -> None:
    """Measures, and prints."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--decisions", type=int, default=40)
    parser.add_argument("--viewers", type=int, default=10)
    options = parser.parse_args()
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as name:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        folder = Path(name)
        (folder / "a").mkdir()
        (folder / "b").mkdir()
        late = decisions(browser, folder / "a", options.decisions, options.viewers)
        ranked = statistics.quantiles(late, n=20)
        print(
            f"{len(late)} decisions on {options.viewers} screens: median {statistics.median(late):.0f} ms, "
            f"95 % within {ranked[-1]:.0f} ms, longest {max(late):.0f} ms"
        )
        taken, size = reloads(browser, folder / "b", 10)
        print(
            f"1,000 steps after a reload: median {statistics.median(taken):.0f} ms, "
            f"longest {max(taken):.0f} ms, {size / 1000:.0f} kB"
        )
        browser.close()


if __name__ == "__main__":
    main()
