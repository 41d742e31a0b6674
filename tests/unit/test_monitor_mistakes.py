import pytest
from dialects import say_the_same
from places import DATA
from projects import files_project
from texts import encoded, write_texts

from aos_editor.symbols import read_bundle
from aos_language.load import load_files
from aos_solver.emission.emit import emit
from aos_solver.emission.lowering.lower import lower

BATTERY = {path.name: path.read_text() for path in sorted((DATA / "bundles" / "battery").iterdir())}
RULE = "response_rule: level < 0.2"
TOPIC = "topic: /battery\nmessage_type: Battery\n"


def findings(**changed: tuple[str, str]) -> list[str]:
    files = dict(BATTERY)
    for name, (find, put) in changed.items():
        file = name.replace("_", ".")
        assert find in files[file]
        files[file] = files[file].replace(find, put)
    loaded = load_files({name: text.encode() for name, text in files.items() if text})
    return [
        f"{finding.severity} {finding.code} {finding.span.file}:{finding.span.line}:{finding.span.column} "
        f"{finding.message}"
        for finding in loaded.diagnostics
    ]


def test_the_bundle_has_no_findings():
    assert findings() == []


@pytest.mark.parametrize(
    ("file", "find", "put", "finding"),
    [
        ("battery_am", "monitor: battery", "monitor: batery",
         "error AOS114 battery.am:2:10 the environment document has no monitor `batery`"),
        ("battery_am", BATTERY["battery.am"], "",
         "error AOS114 drive.ef:24:10 the monitor battery has no abstraction mapping"),
        ("battery_am", "response: low", "response: lo",
         "error AOS116 drive.ef:27:54 the abstraction mapping of battery has no response `low`"),
        ("battery_am", RULE, f"{RULE}\nresponse: unknown\nresponse_rule: level == 0.5",
         "error AOS117 battery.am:5:11 the model of the monitor battery never produces the response unknown"),
        ("battery_am", TOPIC, "from_ros_service_response: true\n",
         "error AOS106 battery.am:8:17 `level` is of a call's result, and a monitor calls nothing"),
        ("battery_am", RULE, "response_rule: __skill_status == 'stopped'",
         "error AOS110 battery.am:4:16 no local variable gives `__skill_status`"),
        ("battery_am", RULE, f"{RULE}\nassign_variable: charge\nvalue: 1",
         "error AOS106 battery.am:5:18 a monitor gives no low-level values"),
        ("battery_am", "monitor: battery", "monitor: battery\nmodule_activation: skill\npath: /battery",
         "error AOS106 battery.am:3:1 a mapping is that of a monitor or calls a skill, not both"),
        ("battery_am", "monitor: battery", "monitor:", "error AOS105 battery.am:2:1 `monitor:` needs a name"),
        ("drive_ef", "if (state.charge == Low) __moduleResponse", 
         "state.charge = Full;\nif (true) __moduleResponse",
         "error AOS123 drive.ef:26:1 `state.charge` is written in the model of a monitor"),
        ("drive_ef", "monitor: battery\ncode:", 
         "monitor: battery\ncode:\nint unused = 0;\nmonitor: battery\ncode:",
         "error AOS111 drive.ef:27:10 a second monitor battery"),
        ("drive_ef", "monitor: battery\ncode:", "monitor: battery\n#",
         "error AOS105 drive.ef:24:10 the monitor battery has no model"),
    ],
)  # fmt: skip
def test_a_mistake_is_told_at_its_line(file, find, put, finding):
    told = findings(**{file: (find, put)})
    assert any(each.startswith(finding) for each in told), told


def test_a_mapping_of_a_monitor_that_is_not_there_is_left_out_of_what_is_compiled():
    files = BATTERY | {"battery.am": BATTERY["battery.am"].replace("monitor: battery", "monitor: batery")}
    draft = load_files({name: text.encode() for name, text in files.items()}).draft
    assert draft is not None
    assert draft.monitors == ()


def test_a_monitor_without_rules_or_topics_says_what_it_lacks():
    text = "project: battery\nmonitor: battery\n"
    told = findings(battery_am=(BATTERY["battery.am"], text))
    assert [each.partition(".am:")[2] for each in told if ".am:" in each] == [
        "1:1 the monitor battery listens to no topic",
        "1:1 the monitor battery has no response rules",
    ]


def test_a_skill_that_says_nothing_of_being_stopped_is_told_where_a_monitor_may_stop_it():
    go = (
        BATTERY["go.am"]
        .replace("__skill_status == 'stopped'", "there == 2")
        .replace("response_rule: True", "response_rule: not there")
    )
    told = findings(go_am=(BATTERY["go.am"], go))
    assert told == ["warning AOS116 battery.am:7:12 no rule says what is observed where this stops go"]


def test_an_editor_knows_the_names_in_both_halves(tmp_path):
    write_texts(BATTERY, tmp_path)
    places: dict[str, list[str]] = {}
    for occurrence in read_bundle(tmp_path, {}).occurrences:
        symbol = occurrence.symbol
        places.setdefault(f"{symbol.kind.value} {symbol.owner} {symbol.name}", []).append(
            str(occurrence.span)
        )
    assert places["response battery low"] == ["battery.am:3:11", "drive.ef:26:66", "drive.ef:27:54"]
    assert "drive.ef:26:11" in places["state variable  charge"]
    assert "battery.am:7:12" in places["local variable battery level"]


def test_two_mappings_of_one_monitor_and_one_called_like_a_skill_are_refused():
    files = encoded(BATTERY)
    files["again.am"] = files["battery.am"]
    told = [f"{finding.code} {finding.span}" for finding in load_files(files).diagnostics]
    assert told == ["AOS111 battery.am:2:10"]
    files = {name: text.replace("monitor: battery", "monitor: go").encode() for name, text in BATTERY.items()}
    assert "AOS111 drive.ef:24:10" in [f"{each.code} {each.span}" for each in load_files(files).diagnostics]


def test_both_dialects_say_the_same():
    say_the_same(encoded(BATTERY))


def test_a_model_is_another_one_with_other_responses_of_a_monitor_and_without_it():
    files = dict(BATTERY)
    digests = {emitted(files)}
    files["battery.am"] = files["battery.am"].replace(
        "response: fine", "response: flat\nresponse_rule: level < 0\nresponse: fine"
    )
    files["drive.ef"] = files["drive.ef"].replace("? fine : low", "? fine : AOS.Bernoulli(0.5) ? flat : low")
    digests.add(emitted(files))
    files["drive.ef"] = files["drive.ef"].partition("monitor:")[0]
    del files["battery.am"]
    digests.add(emitted(files))
    assert len(digests) == 3


def emitted(files: dict[str, str]) -> str:
    program, diagnostics = lower(files_project(encoded(files)))
    assert program is not None, diagnostics
    return emit(program).digest
