from collections.abc import Callable
from typing import Any, NamedTuple

import msgspec
import pytest
from decision_records import decision_record
from places import ROOT

from aos_deploy.history_check import check
from aos_deploy.history_check.check import RULES
from aos_deploy.history_check.files import check_run
from aos_deploy.runs.end import Account, Verdict
from aos_protocol import messages
from aos_runtime.disk.journal import Journal, JournalRow

MISSION = "run"
STEPS = 3

replace = msgspec.structs.replace


def belief(step: int) -> messages.BeliefSummary:
    return messages.BeliefSummary((), 0.0, step / 10, 0.0, 1, True)


def decided(step: int) -> messages.DecisionRecord:
    return decision_record(
        2 * step - 2, MISSION, "go", action=f"go(to={step})", parameters={"to": step}, belief=belief(step - 1)
    )


def outcome(step: int) -> messages.Outcome:
    return messages.Outcome(messages.ActivationId(MISSION, step), "go", "observed", "arrived")


def observed(step: int) -> messages.DecisionRecord:
    return replace(decided(step), sequence=2 * step - 1, belief=belief(step), outcome=outcome(step))


def intended(step: int) -> messages.Activate:
    return messages.Activate(messages.ActivationId(MISSION, step), "go", {"to": step}, 10.0, 1)


def call(step: int) -> messages.SkillCall:
    return messages.SkillCall(
        messages.ActivationId(MISSION, step), "/go", {"x": 1.0}, 10.0, "go", {"to": step}
    )


def state(phase: str, step: int, ending: str = "") -> messages.MissionState:
    return messages.MissionState(MISSION, phase, step, 0.0, ending, revision=1, epoch=1)


class Entry(NamedTuple):
    """A row before it has a number."""

    stamp_ns: int
    kind: str
    payload: messages.Message


class History:
    """A mission of three steps that held before the third; tests change its rows."""

    def __init__(self):
        self.journal: list[Entry] = []
        self.middleware: list[Entry] = []
        self.robot: list[Entry] = []
        self.other: list[Entry] = [
            Entry(5, "started", messages.SkillCall(messages.ActivationId("by-hand", 7), "/look", {}, 1.0)),
            Entry(6, "ended", messages.SkillResult(messages.ActivationId("by-hand", 7), {})),
        ]
        self.summary: Verdict | None = None
        for step in range(1, STEPS + 1):
            self._add_step(step)
        self._write(1000, "mission", state("ended", STEPS, "goal"))

    def _add_step(self, step: int):
        now = 100 * step
        if step == STEPS:
            self._write(now - 20, "mission", state("holding", step - 1))
        self._write(now, "mission", state("planning", step - 1))
        self._write(now + 10, "decision", decided(step))
        self._write(now + 20, "intended", intended(step))
        self.middleware.append(Entry(now + 30, "started", intended(step)))
        self.robot.append(Entry(now + 40, "started", call(step)))
        self.robot.append(
            Entry(now + 50, "ended", messages.SkillResult(messages.ActivationId(MISSION, step), {}))
        )
        self.middleware.append(Entry(now + 60, "ended", outcome(step)))
        self._write(now + 70, "outcome", outcome(step))
        self._write(now + 80, "decision", observed(step))

    def _write(self, stamp_ns: int, kind: str, payload: messages.Message):
        self.journal.append(Entry(stamp_ns, kind, payload))

    def place(self, kind: str, number: int, entries: list[Entry] | None = None) -> int:
        entries = self.journal if entries is None else entries
        return [place for place, entry in enumerate(entries) if entry.kind == kind][number]

    def change(self, kind: str, number: int, entries: list[Entry] | None = None, **changes: Any):
        entries = self.journal if entries is None else entries
        place = self.place(kind, number, entries)
        entries[place] = entries[place]._replace(payload=replace(entries[place].payload, **changes))

    def broken_rules(self) -> set[str]:
        files = {"adapter-robot.db": rows(self.robot), "adapter-other.db": rows(self.other)}
        history = check.History(MISSION, rows(self.journal), self.summary)
        found = check.check_histories([history], rows(self.middleware), files).violations
        assert all(violation.text for violation in found)
        return {violation.rule for violation in found}


def rows(entries: list[Entry]) -> list[JournalRow]:
    return [
        JournalRow(number, entry.stamp_ns, entry.kind, msgspec.json.encode(entry.payload))
        for number, entry in enumerate(entries, 1)
    ]


def test_a_history_that_can_be_breaks_no_rule():
    assert History().broken_rules() == set()


def test_times_before_the_clock_was_set_back_say_nothing_of_the_mission_s_end():
    """Nobody knows either what starts while it holds."""
    history = History()
    day_ns = 86_400 * 10**9
    for entries in (history.journal, history.middleware, history.robot):
        first = len(entries) // 3
        entries[:first] = [entry._replace(stamp_ns=entry.stamp_ns + day_ns) for entry in entries[:first]]
    assert history.broken_rules() == set()
    files = {"adapter-robot.db": rows(history.robot)}
    mission = check.History(MISSION, rows(history.journal))
    assert check.check_histories([mission], rows(history.middleware), files).set_back_ns > day_ns - 1000


def test_a_mission_that_was_killed_at_any_row_breaks_no_rule():
    """The ledgers of a killed run are those of the time when it was killed."""
    whole = History()
    for end in range(len(whole.journal)):
        history = History()
        del history.journal[end:]
        last_ns = history.journal[-1].stamp_ns if history.journal else 0
        for ledger in (history.middleware, history.robot):
            ledger[:] = [entry for entry in ledger if entry.stamp_ns <= last_ns]
        assert history.broken_rules() == set(), end


def test_a_new_solver_replays_what_an_older_model_had_handed_over():
    """The steps before the takeover are explained by the newer model then."""
    for by, broken in (("import", set()), ("replay", {"belief"})):
        history = History()
        history.change("decision", 2, belief=belief(7))
        history.journal.insert(0, Entry(1, "adopted", messages.ModelAdopted(2, "", 1, by, 0)))
        begun = messages.MissionBegun(MISSION, 2, 1, 2, "")
        place = history.place("decision", 2)
        history.journal[place:] = [
            Entry(190, "begun", begun),
            *(
                entry._replace(payload=replace(entry.payload, epoch=2))
                if hasattr(entry.payload, "epoch")
                else entry
                for entry in history.journal[place:]
            ),
        ]
        assert history.broken_rules() == broken, by


def test_a_new_solver_asks_again_with_the_same_id_and_a_new_middleware_takes_it_up():
    history = History()
    again = history.place("intended", 1) + 1
    history.journal.insert(again, Entry(225, "intended", replace(intended(2), epoch=2)))
    for entries in (history.journal[again + 1 :],):
        later = [
            entry._replace(payload=replace(entry.payload, epoch=2))
            if hasattr(entry.payload, "epoch")
            else entry
            for entry in entries
        ]
        history.journal[again + 1 :] = later
    taken_up = Entry(235, "started", replace(intended(2), epoch=2))
    history.middleware.insert(history.place("started", 1, history.middleware) + 1, taken_up)
    history.change("started", 2, history.robot, epoch=2)
    history.change("started", 3, history.middleware, epoch=2)
    assert history.broken_rules() == set()


def test_a_mission_that_was_steered_breaks_no_rule():
    """Step 1 is asked for while somebody holds, 2 is the step that they let the planner make."""
    history = History()
    for number in (0, 1):
        history.change("decision", number, chosen_by="operator")
    at = history.place("decision", 0)
    hold = messages.Steer("hold", by="ana")
    _steer(history, at, hold, messages.Steer("act", ("go(to=1)",), by="ana", request="r"))
    refused = messages.Steer("act", ("stay",), by="ana", request="s")
    at = history.place("decision", 2)
    _steer(history, at, refused, messages.Steer("step", by="ana"))
    history.journal.insert(at + 2, Entry(205, "refused", messages.ActionRefused("stay", "s", "why")))
    _steer(history, history.place("mission", 3), messages.Steer("resume", by="ana"))
    assert history.broken_rules() == set()


def _steer(history: History, place: int, *steers: messages.Steer):
    stamp_ns = history.journal[place].stamp_ns
    history.journal[place:place] = [Entry(stamp_ns, "steered", steer) for steer in steers]


def _steered_before_the_second(history: History, verb: str, *actions: str, **fields: str):
    _steer(history, history.place("decision", 2), messages.Steer(verb, actions, by="ana", **fields))


def _put(entries: list[Entry], place: int, stamp_ns: int, kind: str, payload: messages.Message):
    entries.insert(place, Entry(stamp_ns, kind, payload))


def _move(entries: list[Entry], place: int, stamp_ns: int):
    entries[place] = entries[place]._replace(stamp_ns=stamp_ns)


def _swap_with_the_row_before(history: History, place: int):
    history.journal[place - 1 : place + 1] = history.journal[place], history.journal[place - 1]


def _lose_the_digest(history: History):
    """Particles without a digest may be replaced by a new solver; others may not."""
    for number in (3, 4):
        history.change("decision", number, belief=replace(belief(2), digest="0" if number == 3 else ""))


def _chosen_by_the_operator(history: History, *numbers: int):
    for number in numbers:
        history.change("decision", number, chosen_by="operator")


BREAKS: list[tuple[str, str, Callable[[History], object]]] = [
    ("rows", "damaged", lambda h: _put(h.journal, 4, 0, "decision", state("planning", 1))),
    ("sequence", "gap", lambda h: h.change("decision", 5, sequence=6)),
    ("steps", "decided twice", lambda h: h.change("decision", 1, outcome=None)),
    ("belief", "other", lambda h: h.change("decision", 2, belief=belief(3))),
    ("belief", "of no replay", _lose_the_digest),
    ("epochs", "falls", lambda h: h.change("decision", 0, epoch=2)),
    (
        "epochs",
        "leaps",
        lambda h: _put(
            h.journal, h.place("decision", 2), 190, "begun", messages.MissionBegun(MISSION, 3, 1, 2, "")
        ),
    ),
    ("epochs", "older", lambda h: h.change("started", 0, h.robot, epoch=2)),
    ("intention", "something else", lambda h: h.change("intended", 1, skill="stay")),
    (
        "intention",
        "without a decision",
        lambda h: h.journal.insert(h.place("outcome", 0) + 2, h.journal[h.place("intended", 1)]),
    ),
    ("outcome", "another step", lambda h: h.change("outcome", 1, id=messages.ActivationId(MISSION, 1))),
    ("outcome", "changed on its way", lambda h: h.change("ended", 1, h.middleware, response="lost")),
    ("outcome", "nobody has brought it", lambda h: h.middleware.pop(h.place("ended", 1, h.middleware))),
    (
        "outcome",
        "another record",
        lambda h: h.change("decision", 3, outcome=replace(outcome(2), response="lost")),
    ),
    ("id", "other parameters", lambda h: h.change("started", 1, h.robot, parameters={"to": 9})),
    ("id", "nobody intended it", lambda h: h.other.append(Entry(120, "started", call(4)))),
    ("motion", "twice", lambda h: h.robot.insert(2, h.robot[0])),
    ("motion", "in two adapters", lambda h: h.other.append(h.robot[0])),
    ("motion", "by hand twice", lambda h: h.other.append(h.other[0])),
    (
        "ends",
        "without a start",
        lambda h: _put(h.robot, 0, 1, "ended", messages.SkillResult(messages.ActivationId(MISSION, 3), {})),
    ),
    ("hold", "decides", lambda h: _swap_with_the_row_before(h, h.place("decision", 4))),
    ("hold", "moves", lambda h: _move(h.robot, h.place("started", 1, h.robot), 290)),
    ("steering", "decided while held", lambda h: _steered_before_the_second(h, "hold")),
    ("steering", "wanted before", lambda h: _steered_before_the_second(h, "act", "stay", request="r")),
    ("steering", "nobody wants it", lambda h: _chosen_by_the_operator(h, 2, 3)),
    ("steering", "left out", lambda h: _steered_before_the_second(h, "leave_out", name="go(to=2)")),
    (
        "steering",
        "nobody asked",
        lambda h: _put(
            h.journal, h.place("decision", 2), 205, "refused", messages.ActionRefused("stay", "r", "why")
        ),
    ),
    ("over", "row", lambda h: h.journal.append(Entry(1100, "mission", state("planning", 3)))),
    ("over", "motion", lambda h: _move(h.robot, h.place("started", 2, h.robot), 1001)),
    ("verdict", "differs", lambda h: setattr(h, "summary", replace(Account().verdict(), ending="fault"))),
]


@pytest.mark.parametrize(("rule", "what", "spoil"), BREAKS)
def test_a_history_that_cannot_be_is_caught(rule, what, spoil):
    history = History()
    spoil(history)
    assert rule in history.broken_rules(), what


def test_each_rule_is_broken_by_some_history():
    by_an_engine = {"replay"}  # test_replayed_history.py
    assert {rule for rule, *_ in BREAKS} == RULES.keys() - by_an_engine


def test_the_page_has_each_rule():
    page = (ROOT / "docs" / "reliability.md").read_text()
    assert all(f"| `{name}` | {sentence} |" in page for name, sentence in RULES.items())


def test_a_journal_that_had_no_space_for_its_end_agrees_with_a_summary_that_tells_it():
    history = History()
    del history.journal[-1]
    account = Account()
    for entry in history.journal:
        if isinstance(entry.payload, messages.DecisionRecord | messages.MissionState):
            account.take(entry.payload)
    history.summary = replace(account.verdict(), ending="fault", exit_code=7)
    assert history.broken_rules() == set()
    history.summary = replace(history.summary, actions=("stay",))
    assert history.broken_rules() == {"verdict"}


def test_a_removed_row_is_caught():
    history = History()
    left = [row for row in rows(history.journal) if row.seq != 4]
    found = check.check_histories([check.History(MISSION, left)]).violations
    assert found[0].rule == "rows"
    assert found[0].row == 5


def test_a_journal_that_cannot_be_read_is_a_violation(tmp_path):
    with Journal.open(tmp_path / "journal.db") as journal:
        for entry in History().journal:
            journal.append(entry.kind, entry.payload)
    assert check_run(tmp_path).violations == []
    whole = (tmp_path / "journal.db").read_bytes()
    (tmp_path / "journal.db").write_bytes(whole.replace(b'"go"', b'"g\xff"'))
    (violation,) = check_run(tmp_path).violations
    assert (violation.rule, violation.file) == ("rows", "journal.db")
    assert "journal" not in violation.text
    (tmp_path / "journal.db").unlink()
    assert [(violation.rule, violation.row) for violation in check_run(tmp_path).violations] == [("rows", 0)]
