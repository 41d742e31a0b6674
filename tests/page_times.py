"""Times of the page: `python -m tests.page_times`, or `--decisions 100 --viewers 10`.

A mission whose robot waits for turns is viewed by several browsers. A decision is on the screen when the
page has drawn its step. Beside them a client without a screen reads the event stream: what it waits is the
gateway's and the machine's, the rest is the browsers' own. The processor time of gateway and browsers tells
what a decision costs. Then a mission of 1,000 steps is loaded anew, some times.
"""

import argparse
import os
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent))

from gateway import Gateway, gateway, slow_system
from long_run import write_long_run
from playwright.sync_api import Browser, Page, sync_playwright
from processes import descendants

ROOT = Path(__file__).resolve().parents[1]
CACHE = ROOT / ".compiled"
OBSERVE = """() => {
  window.seen = {};
  const waiting = {};
  window.until = (step) => new Promise((found) => step in window.seen ? found() : (waiting[step] = found));
  const look = () => {
    const text = document.querySelector(".stepper-place b")?.textContent;
    if (text && !(text in window.seen)) requestAnimationFrame(() => {
      window.seen[text] ??= Date.now();
      waiting[text]?.();
    });
  };
  new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
  look();
}"""
"""Nothing is asked of a page in each of its frames: that would cost more than the page."""


def viewed(browser: Browser, served: Gateway, mission: str) -> Page:
    page = browser.new_context(bypass_csp=True, viewport={"width": 1440, "height": 900}).new_page()
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{mission}?token={served.token}")
    page.wait_for_function("document.querySelector('.connection')?.textContent === 'Live'")
    page.evaluate(OBSERVE)
    return page


class Measured(NamedTuple):
    """The milliseconds from decisions until they are on a screen, and until a plain client has them; the
    processor time in milliseconds that a step took the gateway, and all browsers.
    """

    on_screens: list[float]
    by_client: list[float]
    gateway_cpu_ms: float
    browsers_cpu_ms: float


def cpu_ms(pids: Iterable[int]) -> float:
    """The processor time of processes up to now."""
    ticks = 0
    for pid in pids:
        try:
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        except FileNotFoundError:
            continue
        ticks += int(fields[11]) + int(fields[12])
    return 1000 * ticks / os.sysconf("SC_CLK_TCK")


def browser_pids() -> list[int]:
    """The processes of browsers below this one."""
    names = {pid: Path(f"/proc/{pid}/cmdline").read_bytes() for pid in descendants(os.getpid())}
    return [pid for pid, name in names.items() if b"chrom" in name.partition(b"\0")[0]]


def listen(served: Gateway, mission: str, heard: dict[int, float], until: int) -> None:
    """Notes when each decision comes to a client without a screen, up to a step."""
    with served.events(f"/v1/events?mission={mission}&since=0") as events:
        for _, kind, data in events:
            if kind == "decision" and "outcome" not in data["record"]:
                heard[data["record"]["step"]] = time.time() * 1000
                if data["record"]["step"] >= until:
                    return


def decisions(browser: Browser, folder: Path, number: int, viewers: int) -> Measured:
    """Measures so many decisions with so many viewers."""
    heard: dict[int, float] = {}
    with slow_system(folder, CACHE) as run, gateway(folder, CACHE) as served:
        client = threading.Thread(target=listen, args=(served, run.name, heard, number + 1))
        client.start()
        pages = [viewed(browser, served, run.name) for _ in range(viewers)]
        watched = browser_pids()
        before = cpu_ms([served.process.pid]), cpu_ms(watched)
        for step in range(2, number + 2):
            (folder / "turns").write_bytes(b".")
            for page in pages:
                page.evaluate("step => window.until(step)", step)
        after = cpu_ms([served.process.pid]), cpu_ms(watched)
        stamps = {}
        since = 0
        while page_of := served.ask(f"/v1/missions/{run.name}/decisions?since={since}").json["records"]:
            stamps |= {each["step"]: each["stamp_ns"] / 1e6 for each in page_of if "outcome" not in each}
            since = page_of[-1]["sequence"] + 1
        client.join()
        seen = [page.evaluate("window.seen") for page in pages]
        for page in pages:
            page.close()
    steps = range(2, number + 2)
    return Measured(
        [times[str(step)] - stamps[step] for times in seen for step in steps],
        [heard[step] - stamps[step] for step in steps if step in heard],
        (after[0] - before[0]) / number,
        (after[1] - before[1]) / number,
    )


def reloads(browser: Browser, folder: Path, times: int) -> tuple[list[float], int]:
    """The milliseconds until 1,000 steps are drawn after a reload, and the bytes that came."""
    name = write_long_run(folder / "runs", 1000)
    with gateway(folder, CACHE) as served:
        page = browser.new_context(bypass_csp=True, viewport={"width": 1440, "height": 900}).new_page()
        page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}?token={served.token}")
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


def told(late: list[float]) -> str:
    """The times of decisions in words."""
    ranked = statistics.quantiles(late, n=20)
    return (
        f"median {statistics.median(late):.0f} ms, 95 % within {ranked[-1]:.0f} ms, "
        f"longest {max(late):.0f} ms of {len(late)}"
    )


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
        print(f"load {os.getloadavg()[0]:.1f} of {os.cpu_count()} processors")
        measured = decisions(browser, folder / "a", options.decisions, options.viewers)
        print(f"decisions on {options.viewers} screens: {told(measured.on_screens)}")
        print(f"the same at a client without a screen: {told(measured.by_client)}")
        print(
            f"processor time of a step: {measured.gateway_cpu_ms:.0f} ms of the gateway, "
            f"{measured.browsers_cpu_ms:.0f} ms of all browsers"
        )
        taken, size = reloads(browser, folder / "b", 10)
        print(
            f"1,000 steps after a reload: median {statistics.median(taken):.0f} ms, "
            f"longest {max(taken):.0f} ms, {size / 1000:.0f} kB"
        )
        browser.close()


if __name__ == "__main__":
    main()
