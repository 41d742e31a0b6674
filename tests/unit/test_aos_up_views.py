import io
import itertools
import json
import sys
import threading

import pytest
from decision_records import decision_record
from msgspec.structs import replace
from rich.console import Console

from aos_deploy.commands import decisions
from aos_deploy.events import Event, ServiceChanged, Told
from aos_deploy.terminal import console
from aos_deploy.views import make_view
from aos_deploy.views.lines import JsonView, PlainView, decision_line
from aos_deploy.views.live import LiveView, Screen
from aos_protocol.diagnostics import Diagnostic, Severity, Span
from aos_protocol.messages import (
    ActionValue,
    ActivationId,
    BeliefSummary,
    BundleReport,
    EndingOdds,
    Fault,
    Marginal,
    MissionState,
    Outcome,
    SkillProgress,
)

BELIEF = BeliefSummary((Marginal("holding_can", {"true": 0.75, "false": 0.25}),), 0.56, 0.1, 0.0, 2, True)
DECISION = decision_record(
    0,
    skill="pick",
    stamp_ns=1,
    simulations=1000,
    horizon=10,
    planning_s=0.25,
    actions=(ActionValue("serve", -4.0, 100, 0.5, -9.0), ActionValue("pick", 2.713, 900, 0.04, 1.118, 3.001)),
    belief=BELIEF,
    planner="pomcp",
    why="it was asked for",
    threads=2,
)
OUTCOME = Outcome(ActivationId("m", 1), "pick", "observed", "pick_succeeded")
OBSERVED = replace(DECISION, sequence=1, outcome=OUTCOME, surprise=0.5)
REFUSED = BundleReport(
    "armadillo",
    False,
    1,
    (Diagnostic(Severity.ERROR, "AOS110", "unknown name", Span("pick.sd", 7, 2)),),
    source="new",
)
EVENTS: tuple[Event, ...] = (
    ServiceChanged("registry", "ready", 0.5),
    ServiceChanged("skills", "ended", 2.0, "killed by SIGKILL"),
    Told("run directory runs/x"),
    MissionState("m", "building", 0, 0.0, remark="compiling the model"),
    MissionState("m", "building", 0, 0.0, remark="compiling the model"),
    DECISION,
    OBSERVED,
    REFUSED,
    BundleReport("armadillo", True, 2, changed=("the environment",), source="new"),
    BundleReport("armadillo", True, 3, removed=("pick",)),
    MissionState("m", "ended", 1, 0.95, ending="goal", remark="the goal is reached"),
)


def test_a_decision_without_simulations_says_that_nothing_was_searched():
    record = replace(DECISION, planner="sarsop", simulations=0, threads=1)
    assert decision_line(record).endswith("]  sarsop without a search in 0.25 s")


def test_a_decision_that_was_prepared_for_long_says_so():
    record = replace(DECISION, planning_s=8.4, preparation_s=8.35)
    assert decision_line(record).endswith(" in 8.40 s by 2 threads, 8.35 of them preparation")


def test_a_decision_for_less_than_the_best_value_says_why():
    serve = ActionValue("serve", 5.0, 100, 0.5)
    why = "serve cannot be chosen now: no adapter answers calls of /serve"
    record = replace(DECISION, actions=(serve, *DECISION.actions[1:]), why=why)
    assert decision_line(record).endswith(f"  ({why})")
    assert why not in decision_line(replace(DECISION, why=why))


def test_an_action_that_was_not_tried_stands_last_with_no_value():
    untried = ActionValue("serve", 9.0, 0, 1.36)
    record = replace(DECISION, actions=(untried, *DECISION.actions[1:]))
    assert "[pick +2.71 ± 0.04, serve -]" in decision_line(record)


def test_a_decision_among_many_actions_names_the_six_best_and_counts_the_others():
    actions = tuple(replace(DECISION.actions[0], action=f"a{i}", q=float(i)) for i in range(9))
    record = replace(DECISION, actions=actions)
    line = decision_line(record)
    assert "[a8 +8.00" in line
    assert "a3 +3.00 ± 0.50, 3 more]" in line
    assert "a2 " not in line


def test_plain_lines_tell_each_event_once(capsys):
    with PlainView() as view:
        for event in EVENTS:
            view(event)
    assert capsys.readouterr().out.splitlines() == [
        "   0.50 s  registry ready",
        "   2.00 s  skills ended: killed by SIGKILL",
        "run directory runs/x",
        "mission building: compiling the model",
        "step  1: pick  [pick +2.71 ± 0.04, serve -4.00 ± 0.50]  "
        "pomcp, 1000 simulations in 0.25 s by 2 threads",
        "step  1: pick -> pick_succeeded  surprise 0.50  goal 0.100",
        "pick.sd:7:2: error[AOS110]: unknown name",
        "bundle new refused, nothing has changed",
        "bundle new: armadillo revision 2, changed the environment",
        "armadillo revision 3, removed pick",
        "mission ended: the goal is reached",
    ]


def test_the_end_of_each_mission_and_each_hold_are_told_though_the_words_are_the_same(capsys):
    view = PlainView()
    for mission in ("m-1", "m-2"):
        for step, phase, remark in ((2, "holding", "no arm"), (3, "holding", "no arm"), (3, "ended", "done")):
            for _ in range(2):
                view(MissionState(mission, phase, step, 0.0, remark=remark))
    told = ["mission holding: no arm", "mission holding: no arm", "mission ended: done"]
    assert capsys.readouterr().out.splitlines() == told * 2


def test_a_removal_that_is_refused_is_told_with_its_project(capsys):
    PlainView()(BundleReport("fetch", False, 3))
    assert capsys.readouterr().out == "a change of fetch refused, nothing has changed\n"


def test_endings_other_than_the_goal_are_told_where_they_may_be(capsys):
    worse = replace(BELIEF, failure_probability=0.25, over_probability=0.0004)
    PlainView()(replace(OBSERVED, belief=worse))
    assert "goal 0.100  failure 0.250\n" in capsys.readouterr().out


def test_the_goal_without_what_nobody_observed_is_told_where_it_differs(capsys):
    worse = replace(BELIEF, cautious=EndingOdds(0.0, 0.0, 0.0))
    PlainView()(replace(OBSERVED, belief=worse))
    assert "goal 0.100 (cautious 0.000)\n" in capsys.readouterr().out


def test_an_outcome_without_an_observation_says_why(capsys):
    lost = Outcome(OUTCOME.id, "pick", "timed_out", fault=Fault("AOS503", "no answer within 9 s"))
    PlainView()(replace(OBSERVED, outcome=lost))
    assert "pick -> timed_out (no answer within 9 s)" in capsys.readouterr().out


def test_what_a_robot_says_is_one_line_without_commands_to_the_terminal(capsys):
    lost = Outcome(OUTCOME.id, "pick", "failed", fault=Fault("AOS510", "no\nmap \x1b[31m"))
    PlainView()(replace(OBSERVED, outcome=lost))
    assert "pick -> failed (no map  [31m)" in capsys.readouterr().out
    (reason,) = decisions._reason(replace(DECISION, why="\x1b[2J", planner="pomcp"))
    assert reason.isprintable()


def test_of_a_robots_long_error_the_beginning_is_told_and_where_all_of_it_is(capsys):
    lost = Outcome(OUTCOME.id, "pick", "failed", fault=Fault("AOS510", "車輪" * 4000))
    PlainView()(replace(OBSERVED, outcome=lost, remark="車輪" * 4000))
    (line,) = capsys.readouterr().out.splitlines()
    assert line.count("車輪... and 7400 letters more: aos decisions --json") == 2
    assert len(line) < 1500


def test_an_empty_text_as_a_response_is_seen(capsys):
    PlainView()(replace(OBSERVED, outcome=replace(OUTCOME, response="")))
    assert 'pick -> ""  surprise' in capsys.readouterr().out


def test_how_far_a_decision_is_is_told_once_for_each_work(capsys):
    view = PlainView()
    for remark in ("listing states: 1 of 2", "listing states: 2 of 3", "computing first bounds: 1 of 10"):
        view(MissionState("m", "planning", 0, 0.0, remark=remark))
    lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "mission planning: listing states: 1 of 2",
        "mission planning: computing first bounds: 1 of 10",
    ]


def test_every_event_is_one_json_object(capsys):
    with JsonView() as view:
        for event in EVENTS:
            view(event)
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["event"] for line in lines] == [
        "service", "service", "remark", "mission", "mission", "decision", "decision",
        "bundle", "bundle", "bundle", "mission",
    ]  # fmt: skip
    assert lines[5]["actions"][1] == {
        "action": "pick",
        "q": 2.713,
        "n": 900,
        "stderr": 0.04,
        "at_least": 1.118,
        "at_most": 3.001,
    }
    assert lines[6]["outcome"]["response"] == "pick_succeeded"


def shown(screen: Screen, width: int = 120, height: int = 40) -> str:
    text = io.StringIO()
    Console(file=text, width=width, height=height, force_terminal=False).print(screen)
    return text.getvalue()


def test_the_screen_says_what_is_being_waited_for():
    screen = Screen("armadillo")
    screen.take(ServiceChanged("registry", "ready", 0.1))
    screen.take(ServiceChanged("skills", "starting", 0.1))
    assert "waiting for skills ... 0 s" in shown(screen)
    screen.take(EVENTS[3])
    assert "compiling the model ... 0 s" in shown(screen)


def test_the_screen_says_how_far_a_decision_is_and_for_how_long_it_has_been_made():
    screen = Screen("armadillo")
    screen.take(MissionState("m", "planning", 0, 0.0, remark="listing states: 1 of 2"))
    screen.remark_since_s -= 7
    screen.take(MissionState("m", "planning", 0, 0.0, remark="listing states: 2 of 3"))
    assert "listing states: 2 of 3 ... 7 s" in shown(screen)
    screen.take(MissionState("m", "planning", 0, 0.0, remark="computing first bounds: 1 of 10"))
    assert "computing first bounds: 1 of 10 ... 0 s" in shown(screen)
    screen.take(MissionState("m", "compiling", 0, 0.0, remark="compiling " * 12))
    assert "… ... 0 s" in shown(screen, 80, 24)


def test_the_screen_shows_steps_values_and_belief_bars():
    screen = Screen("armadillo")
    for event in EVENTS:
        screen.take(event)
    text = shown(screen)
    bars = next(line for line in text.splitlines() if "holding_can" in line)
    assert bars.split()[:4] == ["holding_can", "true", "███████████████·····", "0.750"]
    for expected in (
        "pick_succeeded",
        "+2.71",
        "-4.00",
        "900",
        "ready: registry",
        "pomcp, 1000 simulations in 0.25 s by 2 threads",
        "goal: the goal is reached",
    ):
        assert expected in text


@pytest.mark.parametrize("width", [80, 132])
def test_a_number_with_many_values_is_shown_by_median_and_range(width):
    depth = Marginal("depth", {"1.234": 0.001}, 0.999, (0.512, 1.0, 1.5, 2.0, 2.468))
    screen = Screen("armadillo")
    belief = replace(OBSERVED.belief, marginals=(depth,))
    screen.take(replace(OBSERVED, belief=belief))
    text = shown(screen, width, 24)
    assert "0.512 to 2.47" in text
    assert "1.234" not in text


PLACES = ("easy_table", "hard_table", "corridor", "kitchen", "charger", "store")
MANY = replace(
    OBSERVED,
    action="navigate(destination=corridor)",
    actions=tuple(
        ActionValue(f"navigate(destination={place})", -12.345 - index, 72_345, 0.071)
        for index, place in enumerate(PLACES)
    ),
    belief=BeliefSummary(
        tuple(Marginal(f"can_{n}_is_at", {"easy_table": 0.75, "robot_hand": 0.25}) for n in range(6)),
        0.56, 0.993, 0.002, 2, True,
    ),
)  # fmt: skip


def small_screen() -> Screen:
    screen = Screen("armadillo · armadillo.yaml")
    for name in ("router", "registry", "middleware", "turtlebot_waffle", "solver"):
        screen.take(ServiceChanged(name, "ready", 0.5))
    for step in range(1, 13):
        screen.take(replace(MANY, step=step, remark="held" if step == 11 else ""))
    screen.take(MissionState("m", "acting", 12, 0.993, remark="navigate(destination=corridor)"))
    return screen


def test_the_screen_fits_80_columns_and_24_rows_with_every_number_whole():
    text = shown(small_screen(), 80, 24)
    for whole in ("step  action", "12  navigate(corridor)", "pick_succeeded", "-14.35  0.07  72,345", "0.75"):
        assert whole in text
    assert "and 3 more" in text
    assert "step 11: held" in text


@pytest.mark.parametrize("width", [80, 100, 132, 200])
@pytest.mark.parametrize("height", [24, 40])
def test_the_screen_keeps_to_the_terminal(width, height):
    lines = shown(small_screen(), width, height).rstrip().splitlines()
    assert len(lines) <= height
    assert max(map(len, lines)) <= width


def test_actions_that_differ_in_their_middle_are_told_apart_in_a_narrow_terminal():
    actions = tuple(ActionValue(f"take(side={side}_side)", 1.0, 10, 0.1) for side in ("left", "right"))
    screen = small_screen()
    screen.take(replace(MANY, step=13, actions=actions, action=actions[0].action))
    words = shown(screen, 40, 24).split()
    assert {"take(l…de)", "take(r…de)", "take(left_side)", "0.993"} <= set(words)


@pytest.mark.parametrize(
    ("state", "progress", "text", "expected"),
    [
        ("executing", 0.42, "moving", "navigate(destination=corridor) ... 0 s  ████······ 42% moving"),
        ("executing", 1.0, "", "0 s  ██████████ 100%"),
        ("executing", 0.5, "very " * 40, "50% very"),
        ("cancelling", 0.1, "its time is over", "0 s  █········· 10% cancelling: "),
        ("accepted", 0.0, "", "navigate(destination=corridor) ... 0 s\n"),
        ("succeeded", 1.0, "", "navigate(destination=corridor) ... 0 s\n"),
    ],
)
def test_the_screen_shows_how_far_the_skill_is(state, progress, text, expected):
    screen = small_screen()
    screen.take(SkillProgress(ActivationId("m", 12), "/navigate", state, progress, text))
    lines = shown(screen, 80, 24)
    assert expected in lines
    assert len(lines.rstrip().splitlines()) <= 24
    assert max(map(len, lines.splitlines())) <= 80


def test_progress_of_another_step_or_by_hand_is_not_shown_as_that_of_the_skill():
    for mission, step in (("m", 11), ("by-hand", 12)):
        screen = small_screen()
        screen.take(SkillProgress(ActivationId(mission, step), "/navigate", "executing", 0.5))
        assert "50%" not in shown(screen, 80, 24)


def test_the_screen_that_is_left_behind_turns_no_more(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    text = io.StringIO()
    with LiveView("armadillo", Console(file=text, width=80, height=24, force_terminal=True)) as view:
        view(Told(f"page http://127.0.0.1:8080/#/?token={'t' * 60}"))
        assert f"{'t' * 60}\n" in text.getvalue()
        view(MissionState("m", "planning", 0, 0.0))
        view(DECISION)
        view(ServiceChanged("solver", "stopping", 2.0))
        assert "⠋ stopping solver ... 0 s" in text.getvalue()
        view(Told("cancelled after 1 step"))
    rest = text.getvalue().rpartition("pick")[2]
    assert "cancelled after 1 step" in rest
    assert not set("⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏") & set(rest)


def test_a_screen_is_drawn_by_one_thread_while_another_tells_it_events():
    screen, is_drawn, shown_on = Screen("armadillo"), threading.Event(), Console(file=io.StringIO())

    def tell():
        for number in itertools.cycle(range(3000)):
            if number == 0:
                screen.services = {}
            screen.take(ServiceChanged(f"{number}", "ready", 0.0))
            if is_drawn.is_set():
                return

    before_s = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    telling = threading.Thread(target=tell)
    telling.start()
    try:
        for _ in range(500):
            list(screen.__rich_console__(shown_on, shown_on.options))
    finally:
        sys.setswitchinterval(before_s)
        is_drawn.set()
        telling.join()


def test_without_colour_there_is_no_style_at_all(monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("FORCE_COLOR", "1")
    shown_on = console()
    with shown_on.capture() as captured:
        shown_on.print("value", style="bold red")
    assert captured.get() == "value\n"


def test_the_screen_says_what_was_remarkable_about_a_step():
    screen = Screen("armadillo")
    screen.take(replace(OBSERVED, remark="the local variables do not correct the belief"))
    screen.take(replace(DECISION, sequence=2, step=2))
    assert "step 1: the local variables do not correct the belief" in shown(screen)


@pytest.mark.parametrize(
    ("options", "kind"),
    [
        ({"is_plain": False, "is_json": False, "is_terminal": True}, LiveView),
        ({"is_plain": True, "is_json": False, "is_terminal": True}, PlainView),
        ({"is_plain": False, "is_json": False, "is_terminal": False}, PlainView),
        ({"is_plain": False, "is_json": True, "is_terminal": True}, JsonView),
    ],
)
def test_the_view_fits_where_it_is_shown(options, kind):
    assert isinstance(make_view("armadillo", **options), kind)
