import json
import os
import re
import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import long_run
import pytest
from gateway import Gateway, gateway, worn_system
from long_run import write_long_run
from page_sources import installed_sources
from places import BUNDLES, DEPLOY
from playwright.sync_api import Browser, Page, Route, expect, sync_playwright
from processes import HANG_S

from aos_protocol.messages import Marginal, PredictedObservation

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
VIEWS = ("", "/why", "/steps", "/model", "/documents", "/system")
MOST_BYTES = 400_000
AXE = "node_modules/axe-core/axe.min.js"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A browser without a window; tests skip where the machine has none."""
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip(f"needs a browser: none of {', '.join(BROWSERS)} is there")
    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(autouse=True)
def closed_pages(browser: Browser) -> Iterator[None]:
    """A page that stays open follows its mission, and takes the processor from the next test."""
    yield
    for context in browser.contexts:
        context.close()


def opened(browser: Browser, served: Gateway, width: int = 1440) -> Page:
    """A page that has the token. An error in its scripts fails the test."""
    page = browser.new_page(viewport={"width": width, "height": 900})
    page.set_default_timeout(HANG_S * 1000)
    expect.set_options(timeout=HANG_S * 1000)
    page.on("pageerror", lambda error: pytest.fail(f"a script failed: {error}"))
    page.goto(f"http://127.0.0.1:{served.port}/#/?token={served.token}")
    expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
    return page


def kept(page: Page, name: str):
    if folder := os.environ.get("AOS_PAGE_PICTURES"):
        page.screenshot(path=Path(folder) / f"{name}.png", full_page=True)


def screens(page: Page) -> Iterator[str]:
    """Has the page on a narrow dark screen and then on a wide light one; gives each as a part of a name."""
    for width, theme in ((390, "dark"), (1440, "light")):
        page.set_viewport_size({"width": width, "height": 900})
        page.emulate_media(color_scheme=theme)
        yield f"{width}-{theme}"


# The page's policy refuses what `wait_for_function` evaluates from its second look on.
FITS = """() => new Promise(told => {
    let frames = 600;
    const look = () => {
        const fits = document.documentElement.scrollWidth <= innerWidth;
        if (fits || --frames === 0) told(fits);
        else requestAnimationFrame(look);
    };
    look();
})"""


def wait_for_width(page: Page):
    """Waits until nothing is wider than the screen, which charts follow a frame later."""
    assert page.evaluate(FITS), "something stays wider than the screen"


def violations(page: Page) -> list[tuple[str, list[str]]]:
    """The findings of the accessibility checker: the rule, and the elements. A screen may not be too wide."""
    wait_for_width(page)
    page.evaluate((installed_sources() / AXE).read_text())
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [(each["id"], [node["target"] for node in each["nodes"]]) for each in found]


@pytest.fixture(scope="module")
def worn(tmp_path_factory) -> Iterator[tuple[Gateway, str]]:
    """A gateway, and a mission of a system that stays, which has ended with an alarm."""
    folder = tmp_path_factory.mktemp("worn")
    with worn_system(folder) as run, gateway(folder) as served:
        yield served, f"{run.name}-1"


def test_slider_and_keys_move_all_views_and_the_address(browser: Browser, past: tuple[Gateway, str]):
    served, name = past
    steps = served.ask(f"/v1/missions/{name}/trace").json["steps"]
    page = opened(browser, served)
    newest = re.compile("/v1/missions/latest")  # the machine may have newer ones
    page.route(newest, lambda asked: asked.continue_(url=asked.request.url.replace("latest", name)))
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/latest")
    expect(page.locator(".decision .action")).to_have_text(steps[-1]["action"])
    page.keyboard.press("ArrowLeft")
    expect(page).to_have_url(re.compile(rf"\?step={len(steps) - 1}$"))
    page.reload()
    expect(page.locator("tr[aria-selected=true] .row-step")).to_have_text(str(len(steps) - 1))
    page.get_by_role("slider", name="Step").fill("1")
    expect(page.locator(".decision .action")).to_have_text(steps[0]["action"])
    expect(page.locator(".value.is-chosen")).to_have_attribute("aria-label", re.compile("chosen"))
    expect(page.get_by_alt_text("The state after step 1")).to_be_visible()
    page.get_by_role("link", name="Why", exact=True).click()
    page.get_by_role("button", name="Show the tree").click()
    expect(page.locator(".tree .branches").first).to_contain_text(f"{steps[0]['action']} ")
    expect(page.locator(".tree details[open] > summary").last).to_contain_text("seen")
    assert violations(page) == []
    page.get_by_role("link", name="Overview", exact=True).click()
    page.keyboard.press("Tab")
    page.locator("h1").click()
    page.keyboard.press("End")
    expect(page).to_have_url(re.compile(rf"/missions/{name}$"))
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/cut%E0%A4")
    expect(page.get_by_role("main")).to_contain_text("there is no mission cut")
    expect(page.locator(".connection")).to_have_text("No such mission")
    page.evaluate("localStorage.clear()")
    page.context.clear_cookies()
    page.reload()
    expect(page.locator(".connection")).to_have_text("No access")


def late(browser: Browser, served: Gateway, run: Path, view: str = "") -> Page:
    (run.parents[1] / "turns").write_bytes(b".")
    page = opened(browser, served)
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{run.name}{view}")
    expect(page.locator(".stepper-place")).to_have_text("2 of 2")
    return page


def test_whoever_joins_late_sees_each_step_live_and_can_hold_act_and_stop(
    browser: Browser, living: tuple[Gateway, Path]
):
    served, run = living
    page = late(browser, served, run)
    expect(page.locator(".connection")).to_have_text("Live")
    (run.parents[1] / "turns").write_bytes(b".")
    expect(page.locator(".stepper-place")).to_have_text("3 of 3")
    kept(page, "living")

    def answer_late(route: Route):
        """Keeps the answer, given while the skill runs, until the page shows that the mission holds."""
        answer = route.fetch()
        expect(page.locator(".phase")).to_contain_text("Holding")
        route.fulfill(response=answer)

    page.route("**/steering", answer_late, times=1)
    page.get_by_role("button", name="Hold").click()
    expect(page.get_by_role("button", name="Go on")).to_be_visible()
    (run.parents[1] / "turns").write_bytes(b".")
    expect(page.get_by_role("button", name="Do listen")).to_be_enabled()
    expect(page.locator(".phase")).to_contain_text("Holding")
    page.get_by_role("button", name="Do listen").click()
    expect(page.locator(".decision .sentence")).to_contain_text("was asked for by a person")
    page.get_by_role("button", name="Leave out open(door=left_door)").click()
    expect(page.get_by_role("button", name="Take it back")).to_be_enabled()
    (run.parents[1] / "turns").write_bytes(b".")
    page.get_by_role("button", name="Step", exact=True).click()
    expect(page.locator(".decision .sentence")).to_contain_text("is worth")
    expect(page.locator(".value")).to_have_count(2)
    expect(page.get_by_text("is left out by")).to_have_count(1)
    page.get_by_role("button", name="Stop").click()
    expect(page.locator(".phase")).to_contain_text("Cancelled")
    expect(page.get_by_role("button", name="Stop")).to_have_count(0)


def test_a_lost_connection_is_told_what_was_missed_comes_when_it_is_back_and_a_killed_run_is_told(
    browser: Browser, living: tuple[Gateway, Path], tmp_path
):
    served, run = living
    page = opened(browser, served)
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{run.name}")
    expect(page.locator(".connection")).to_have_text("Live")
    served.process.terminate()
    served.process.wait(HANG_S)
    expect(page.locator(".connection")).to_contain_text("Connection lost")
    (run.parents[1] / "turns").write_bytes(b".")
    with gateway(tmp_path, "--port", str(served.port)):
        expect(page.locator(".connection")).to_have_text("Live")
        expect(page.locator(".stepper-place")).to_have_text("2 of 2")
        expect(page.get_by_role("button", name="Hold", exact=True)).to_be_visible()
        os.kill(json.loads((run / "run.json").read_text())["pid"], signal.SIGKILL)
        expect(page.locator(".phase[role=status]")).to_contain_text("Killed")
        expect(page.locator(".remark").first).to_contain_text("aos-up --resume")
        expect(page.locator(".came")).to_contain_text("How it ended is not known.")
        expect(page.locator(".value")).to_have_count(3)
        expect(page.get_by_role("button", name="Hold", exact=True)).to_have_count(0)
        expect(page.locator(".connection")).to_contain_text("Recorded")


def test_a_mission_is_started_from_the_list(browser: Browser, past: tuple[Gateway, str]):
    served, _ = past
    page = opened(browser, served)
    bundle = shutil.make_archive(str(Path(served.folder) / "errand"), "zip", BUNDLES / "errand")
    page.locator("input[type=file]").set_input_files(bundle)
    expect(page.get_by_label("Project")).to_have_value(re.compile(r"errand\.yaml$"))
    page.get_by_role("button", name="Start mission").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("errand")
    expect(page.locator(".phase, .problem").first).to_be_visible()


def test_an_alarm_is_in_the_head_and_on_the_model_view_from_its_step_on(
    browser: Browser, worn: tuple[Gateway, str]
):
    served, name = worn
    rows = served.ask(f"/v1/missions/{name}/trace").json["steps"]
    first = next(row for row in rows if "drift" in row)
    alarm = first["drift"][0]
    page = opened(browser, served, 390)
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}?step={first['step']}")
    page.get_by_role("link", name="The model of press does not hold").click()
    cells = page.locator(".alarms tbody tr").first.locator("td")
    told = [f"{alarm['modelled']:.2f}", f"{alarm['seen']:.2f}", str(alarm["uses"]), str(first["step"])]
    expect(cells).to_have_text(["press", alarm["response"], *told])
    for screen in screens(page):
        kept(page, f"alarm-{screen}")
        assert violations(page) == []
    page.keyboard.press("ArrowLeft")
    expect(page.locator(".alarm")).to_have_count(0)


def test_documents_that_are_given_in_mid_mission_take_over_at_a_diamond_and_are_shown(
    browser: Browser, living: tuple[Gateway, Path]
):
    served, run = living
    address = f"http://127.0.0.1:{served.port}/#/missions/{run.name}"
    page = late(browser, served, run, "/system")
    expect(page.locator(".presence.is-there").first).to_be_visible()
    refused = served.ask(f"/v1/runs/{run.name}/bundles?name=listen.sd", "POST", b"project: tiger\n")
    assert refused.status == 422
    expect(page.locator(".push .problem")).to_contain_text("listen.sd was refused; nothing has changed")
    better = (run.parents[1] / "tiger/listen.sd").read_text().replace("0.85 : 0.15", "0.95 : 0.05")
    given = {"name": "listen.sd", "mimeType": "text/plain", "buffer": better.encode()}
    page.locator("input[type=file]").set_input_files(given)
    expect(page.locator(".push [role=status]")).to_contain_text("Accepted: revision 2, listen")
    known = served.ask(f"/v1/missions/{run.name}/trace").json["next"]
    with served.events(f"/v1/events?mission={run.name}&since={known}") as events:
        told = (data for _, kind, data in events if kind == "decision")
        rows = (data["row"] for data in told if "outcome" not in data["record"])
        has_taken_over = False
        while not has_taken_over:
            (run.parents[1] / "turns").write_bytes(b".")
            has_taken_over = "adopted" in next(rows)
    expect(page.locator(".timeline-track path.adopted")).to_have_count(1)
    expect(page.locator(".legend")).to_contain_text("new model")
    kept(page, "hot-plug")
    page.goto(f"{address}/documents")
    expect(page.locator(".card", has_text="Documents of tiger")).to_contain_text("Revision 2")
    expect(page.locator(".source")).to_contain_text("0.95 : 0.05")
    page.goto(f"{address}/documents?step=1")
    expect(page.locator(".source")).to_contain_text("0.85 : 0.15")


def test_the_next_mission_is_begun_where_one_has_ended(browser: Browser, worn: tuple[Gateway, str]):
    served, name = worn
    page = opened(browser, served, 390)
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}")
    page.get_by_text("Next mission").click()
    page.get_by_label("What is known").fill("state.is_lit")
    page.get_by_role("button", name="Begin it").click()
    expect(page.locator(".next .problem")).to_contain_text("AOS516")
    for screen in screens(page):
        kept(page, f"next-{screen}")
        assert violations(page) == []
    page.get_by_label("What is known").fill("state.is_lid")
    page.get_by_role("button", name="Begin it").click()
    expect(page.locator(".next .problem")).to_contain_text("Did you mean `is_lit`?")
    expect(page.locator(".next").get_by_text("unknown state variable")).to_have_count(1)
    page.get_by_label("What is known").fill("!state.is_lit")
    page.get_by_label("Belief at the start").select_option("keep")
    page.get_by_role("textbox", name="room").fill("lab")
    page.get_by_role("button", name="Begin it").click()
    expect(page).to_have_url(re.compile(f"{name[:-1]}2$"))
    expect(page.locator(".decision .action")).to_have_text("press(room=lab)")
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name[:-1]}2/system")
    end = page.get_by_role("button", name="End the system")
    kept(page, "end")
    end.click()
    expect(end).to_have_count(0)
    assert not served.ask(f"/v1/runs/{name[:-2]}").json["is_running"]


def test_every_view_has_an_address_fits_the_screen_and_can_be_used_by_everybody(
    browser: Browser, past: tuple[Gateway, str]
):
    served, name = past
    action = served.ask(f"/v1/missions/{name}/trace").json["steps"][1]["action"]
    page = opened(browser, served, 390)
    for view in ("list", *VIEWS):
        if view != "list":
            page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}{view}?step=2")
            expect(page.locator(".decision .action")).to_have_text(action)
            expect(page.locator(".stepper-place")).to_have_text(re.compile(r"^2 of \d+$"))
        for screen in screens(page):
            expect(page.locator("main .card").last).to_be_visible()
            expect(page.locator("[aria-busy=true]")).to_have_count(0)
            kept(page, f"{screen}{view.replace('/', '-')}")
            assert violations(page) == [], (view, screen)


def test_a_number_of_many_values_is_shown_by_its_median_and_range(
    browser: Browser, past: tuple[Gateway, str]
):
    served, _ = past
    depth = Marginal("depth", {"1.512345": 0.001}, 0.999, (-0.5123, 1.0, 1.5123, 2.0, 2.5123))
    name = write_long_run(served.folder / "runs", 5, depth)
    page = opened(browser, served, 390)
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}")
    told = ["wait is left out by ana", "put cannot be chosen now: the arm is off"]
    for screen in screens(page):
        expect(
            page.get_by_role("img", name=re.compile(r"depth: median 1\.51, 5.95 % .0\.51 … 2\.51$"))
        ).to_be_visible()
        kept(page, f"numbers-{screen}")
        expect(page.locator(".values .aside")).to_have_text(told)
        assert violations(page) == []


def test_long_names_are_told_whole_and_widen_no_screen(
    browser: Browser, past: tuple[Gateway, str], monkeypatch
):
    served, _ = past
    long = "where_the_robot_that_carries_the_longest_of_all_names_stands_at_the_moment"
    actions = tuple(
        f"inspect_the_shelf(target=shelf_in_the_north_eastern_corridor_{n:03d})" for n in range(200)
    )
    monkeypatch.setattr(long_run, "SKILLS", actions)
    texts = tuple(PredictedObservation(f"{long}_{number}", 0.001) for number in range(1000))
    monkeypatch.setattr(long_run, "PREDICTED", texts)
    certain = (Marginal(f"{long}_{number}", {f"value_of_{long}": 1.0}) for number in range(30))
    name = write_long_run(served.folder / "runs", 120, Marginal(long, {long: 0.9, "other": 0.1}), *certain)
    page = opened(browser, served, 390)
    is_cut = "all => all.filter(each => each.scrollWidth > each.clientWidth).length"
    for view in ("/why", "/steps", "/model", ""):
        page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}{view}?step=110")
        expect(page.locator(".stepper-place")).to_have_text("110 of 120")
        for screen in screens(page):
            wait_for_width(page)
            assert page.locator(".scroll").evaluate_all(is_cut) == 0, (view, screen)
            kept(page, f"long-{screen}{view.replace('/', '-')}")
        if view == "/steps":
            lines = "all => all.map(each => each.getClientRects().length)"
            assert {*page.locator(".steps td:nth-child(4) .whole").evaluate_all(lines)} == {1}
        if view == "/model":
            expect(page.locator(".expected li")).to_have_count(12)
            expect(page.locator(".expected li").last).to_have_text("all others120/120")
    for _ in screens(page):
        expect(page.locator(".value-name")).to_have_count(9)
        assert page.locator(".value-name, .ribbon, .steps td").evaluate_all(is_cut) == 0
        assert page.locator(".row-step").first.evaluate("each => each.offsetHeight") < 30


def test_a_thousand_steps_are_loaded_with_little_and_nothing_is_said_of_them_before(
    browser: Browser, past: tuple[Gateway, str]
):
    served, _ = past
    name = write_long_run(served.folder / "runs", 1000)
    page = opened(browser, served)
    page.goto("about:blank")
    held: list[Route] = []
    page.route("**/trace", lambda route: held.append(route))
    page.goto(f"http://127.0.0.1:{served.port}/#/missions/{name}")
    expect(page.locator("main")).to_contain_text("The mission is being read")
    expect(page.locator("main")).not_to_contain_text("yet")
    expect(page.locator(".phase")).to_have_text("Reading")
    held.pop().continue_()
    expect(page.locator(".stepper-place")).to_have_text("1000 of 1000")
    expect(page.locator("[aria-busy=true]")).to_have_count(0)
    sizes = "performance.getEntriesByType('resource').reduce((sum, each) => sum + each.transferSize, 0)"
    assert page.evaluate(sizes) <= MOST_BYTES
    kept(page, "thousand")


def test_a_mission_whose_model_is_compiled_says_so_everywhere_and_another_follows_where_it_is_stopped(
    browser: Browser, tmp_path, monkeypatch
):
    compiler = tmp_path / "c++"
    compiler.write_text('#!/bin/sh\ncase "$*" in *version*) exec c++ "$@";; esac\nexec sleep 1000\n')
    compiler.chmod(0o755)
    monkeypatch.setenv("CXX", str(compiler))
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "cache"))
    with gateway(tmp_path) as served:
        start = {"deploy_file": str(DEPLOY / "errand.yaml"), "model": True, "stay": True}
        started = served.post("/v1/runs", start)
        page = opened(browser, served)
        page.goto(f"http://127.0.0.1:{served.port}/#/missions/latest")
        expect(page.locator(".phase")).to_have_text("Compiling the model")
        expect(page.get_by_role("button", name="Hold")).to_have_count(0)
        state = served.ask("/v1/missions/latest").json["state"]
        assert (state["mission"], state["phase"]) == (started.json["mission"], "compiling")
        with served.events("/v1/events?mission=latest") as events:
            assert next(data for _, kind, data in events if kind == "state") == state
        page.get_by_role("button", name="Stop").click()
        expect(page.get_by_text("Next mission")).to_have_count(1)
        expect(page.get_by_role("button", name="Stop")).to_have_count(0)
        record = json.loads((tmp_path / "runs/latest/run.json").read_text())
        os.kill(record["pid"], signal.SIGINT)
        expect(page.locator(".phase")).to_have_text("Stopped")
