"""The forms that documents may have: what is accepted, with which warning, and what is refused where.

What tests/golden/documents, mistakes.toml and test_constructs.py refuse is not said again. One rule a line,
written as in tests/marked_change.py, over the two bundles `rooms` in tests/data, which have
no findings.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import pytest
from marked_change import changed
from places import DATA
from texts import encoded

from aos_language.load import LoadedBundle, load_bundle, load_files
from aos_protocol.diagnostics import Severity, Span

BUNDLES = DATA / "bundles"
JSON = {path.name: path.read_text() for path in (BUNDLES / "rooms-json").iterdir()}
SDL = {path.name: path.read_text() for path in (BUNDLES / "rooms-sdl").iterdir()}


class Rule(NamedTuple):
    """The rule that in `file` this change is accepted, or told with this code at its mark."""

    file: str
    change: str
    code: str = ""
    title: str = ""


ACCEPTED = [
    # JSON as people write it.
    Rule("room.json", '"Horizon": «5→5.0»,'),
    Rule("room.json", '"Discount": «0.9→1»'),
    Rule("room.json", '"Reward": «5.0→5»'),
    Rule("room.json", '"Reward": «5.0→-0.25e1, "IsFailureState": false»'),
    Rule("go.json", "-«2→2.5»\n"),
    Rule("go.json", '«, "Version": 1→»'),
    Rule("go.json", '"Version": «1→null»'),
    Rule("room.json", '«"Name": "environment", →»'),
    Rule("room.json", '"Default": "eHall«→;»"}', title="a semicolon behind a default"),
    Rule("room.json", "state.at == eLab«→; »"),
    Rule("room.json", '«"state.door.room = eLab;"→["state.door.room =", "eLab;"]»', title="code as lines"),
    Rule("go.json",
         '{"«IterateNextStateVars": []→AssignmentName": "nothing", "AssignmentCode": "// later"»}'),
    Rule("go.json",
         '{"«IterateNextStateVars": []→TempVar": {"VarName": "", "Type": "", "EnumValues": []}»}'),
    Rule("go.json", '{"«IterateNextStateVars": []→AssignmentCode": null, "TempVar": null»}'),
    Rule("go.json", "__reward = -1;«→ if (!state.closed[1]) return;»"),
    Rule("go.json", "AOS.«→ »SampleDiscrete", title="a blank behind AOS."),
    Rule("go.json", "end == «eWell→tEnd + 1» ? eDone", title="a temporary enum's name is a number"),
    Rule("go glue.json", '«"VariableType": "bool", →»'),
    Rule("go glue.json", '«→["ok = False", »"ok = __input.success"«→]»'),
    Rule("go glue.json", '«"ok"→["ok", "or not ok"]»}', title="a rule as lines"),
    Rule("go glue.json", '«"GlueFramework": "ROS",\n→»'),
    Rule("go glue.json", '"«RosService→RosAction»"'),
    Rule("go glue.json", '"ServicePath": "«/→»go"'),
    Rule("go glue.json",
         '«→"ImportCode": [{"From": "robot.msg", "Import": ["Point , Pose", "Turn as T"]}], '
         '»"ServiceParameters": [{"ServiceFieldName": "goal", "AssignServiceFieldCode": '
         '"«→T(a=Pose(a=Point(a=»goal«→)))»', title="two imports in one text"),
    # The paper's words.
    Rule("room.json", '"«PlpMain→GsdlMain»"'),
    Rule("go.json", '"«PlpMain→GsdlMain»": {"Project": "two rooms", "Name": "go", "Type": "«PLP→GSDL»"'),
    Rule("go glue.json", '"Type": "«Glue→AM»"'),
    # SDL.
    Rule("room.ef", "«discount: 0.9\n→»"),
    Rule("room.ef", "discount: «0.9→1»"),
    Rule("room.ef", "project:« two rooms→\ttwo rooms \t\t»"),
    Rule("room.ef", "horizon«: 5→ : 5   // decisions»"),
    Rule("room.ef", "Hall, «→// the first\n\n  // and\n  »Lab"),
    Rule("room.ef", "steps« →»[]"),
    Rule("room.ef", "int« steps []→[] steps»"),
    Rule("room.ef", "«int steps []→vector<int> steps»"),
    Rule("room.ef", "is_open true«→ 1»", title="a scale for the learning planner"),
    Rule("room.ef", "is_open true«→ ml_ignore»"),
    Rule("room.ef", "state_variable: Room at\n«→ml_max_value: 2\n»"),
    Rule("go.sd", "precondition:«\n→ »"),
    Rule("go.sd", "__reward = -1;\n«→\t»"),
    Rule("go.sd", "«→\t»violate_penalty: -«2→2.5»"),
    Rule("go.am", "response: arrived\n«→\n»"),
    Rule("go.am",
         "response_rule: ok«→\nresponse: arrived\nresponse_rule:»", title="a rule with nothing behind it"),
    Rule("go.am", "activation: «ros_service→ros_action»"),
    Rule("go.am", "response_rule: ok«→ and\n  # as it says\n  True»"),
    Rule("go.am", "«→# a comment\n\t»ok = __input.success\n«→\t»"),
]  # fmt: skip

WARNED = [
    Rule("go.am", "ok = __input.success«→§,»", "AOS149"),
    Rule("go.am", "response_rule: ok«→§,»\n", "AOS149"),
    Rule("go.am", "ok = __input.success«→\n§return»", "AOS121"),
    Rule("room.json", '"Discount": 0.9§«→,»}', "AOS127"),
    Rule("room.json", 'false};"}§«→,»\n', "AOS127"),
    Rule("room.json", '§«→// what counts\n»"SpecialStates"', "AOS127"),
    Rule("room.json", '§«→/* what\ncounts */»"SpecialStates"', "AOS127"),
    Rule("room.json", '"Default": §«"eHall"→0»},', "AOS127"),
    Rule("room.json", '"Type": "§«enum→Enum»"', "AOS127", title="a kind of type in capitals"),
    Rule("go.json", '"Type": "tDoor"«→, "§s": 1»}', "AOS102"),
    Rule("go.json",
         '"eBadly"«→, "eNever"»]},\n     "AssignmentCode": "end = AOS.SampleDiscrete(tEnd, §{', "AOS122"),
    Rule("go.json", "{0.9, 0.1})§«;→»", "AOS127"),
    Rule("go.json", "oDoor.room§«;→» }", "AOS127"),
    Rule("go.json", "__reward = -1;«→ if (__reward) return; §elseif (state.closed[1]) return;»", "AOS127"),
    Rule("room.ef", "«AOS.Bernoulli(0.5) ? 1 : 0;→0; vector<double> w = §{0.5, 0.4};\n"
         "state.steps[0] = AOSUtils::SampleDiscrete(w);»", "AOS122", title="weights that have a name"),
    Rule("go.json", '§"«→RequiredResources": [], "»DynamicModel"', "AOS102"),
    Rule("go glue.json", '§«""→true»}', "AOS127"),
    Rule("go glue.json", '"ModuleResponse": {§«→"EnumResponse": [], »', "AOS102"),
    Rule("room.ef", "is_open §«→= »true", "AOS127"),
    Rule("room.ef", "state_variable: «→int §spare\nstate_variable: »Room", "AOS133"),
    Rule("go.sd", "«→int arrived = 1;\n»__moduleResponse = §", "AOS126"),
    Rule("go.sd", "-2§«→;»\n", "AOS127"),
    Rule("go.am", "srv: Go«→\nimports: §from go.srv import Go»", "AOS127"),
    Rule("go.am", "type: §«bool→Bool»", "AOS127"),
]  # fmt: skip

REFUSED = [
    Rule("room.json", '"Discount": §«0.9→1.1»', "AOS106"),
    Rule("room.json", '"Type": "«anyValue→int»"', "AOS106"),
    Rule("go.json", '"«Type→Kind»": "PLP"', "AOS105"),
    Rule("go.json", '"Type": "«tDoor→float»"}', "AOS119"),
    Rule("go.json", "§{«0.9, 0.1→0, 0»}", "AOS122"),
    Rule("go.json", '"eWell", "«eBadly→eDone»"]', "AOS126", title="a hidden response"),
    Rule("go.json", "__meetPrecondition =§«→\u00a0»", "AOS108", title="blank"),
    Rule("room.json", '"«IsArray": true→Parameters": ["tRom"]»,', "AOS110", title="keys of no enum"),
    Rule("room.json", '"§«IsArray→IsAray»": true', "AOS102"),
    Rule("go.json", "§{«0.9, 0.1→0.5, 0.3, 0.2»}", "AOS122"),
    Rule("go.json", "§{«0.9, 0.1→1»}", "AOS122"),
    Rule("go.json", "AOS.SampleDiscrete(§«tEnd→tEdn»", "AOS110"),
    Rule("go.json", "__reward = -1;«→ if (__reward) return; elseif (state.§shut) return;»", "AOS110"),
    Rule("go glue.json", '"§«RosService→ROSService»"', "AOS102"),
    Rule("room.ef", "§Hall«→ = 5», ", "AOS126"),
    Rule("go.sd", "parameter: Door §door«→-2»", "AOS126"),
    Rule("go.sd", "parameter: §«Door door→door int»", "AOS104"),
    Rule("go glue.json", '«"ok"→["ok", "§) or (ok"]»}', "AOS121"),
    Rule("go glue.json", '§"«FromROSServiceResponse": true→RosParameter": "/ok"»', "AOS124"),
    Rule("go glue.json", '"ok = __input.success"}«→, {"LocalVariableName": "§ok", '
         '"FromROSServiceResponse": true, "AssignmentCode": "ok = __input.ok"}»', "AOS126", title="twice ok"),
    Rule("room.ef", "is_open« true→[2]»", "AOS104"),
    Rule("go.am", "«→    ok = 1\n  »ok = __input", "AOS121"),
]  # fmt: skip


def bundle_of(rule: Rule) -> tuple[dict[str, bytes], Span]:
    files = JSON if rule.file in JSON else SDL
    return changed(encoded(files), rule.file, rule.change)


def named(rule: Rule) -> str:
    return rule.title or f"{rule.code} {rule.change}".strip().replace("\n", " ")


def found_by(loaded: LoadedBundle) -> list[str]:
    return [f"{finding.span} {finding.code} {finding.message}" for finding in loaded.diagnostics]


@pytest.mark.parametrize("files", [JSON, SDL], ids=["json", "sdl"])
def test_the_bundles_of_the_rules_have_no_findings(files):
    assert found_by(load_files(encoded(files))) == []


@pytest.mark.parametrize("rule", ACCEPTED, ids=named)
def test_this_is_accepted_without_a_word(rule):
    loaded = load_files(bundle_of(rule)[0])
    assert found_by(loaded) == []
    assert loaded.project is not None


@pytest.mark.parametrize("rule", WARNED, ids=named)
def test_this_is_accepted_with_one_warning_at_its_place(rule):
    files, place = bundle_of(rule)
    loaded = load_files(files)
    assert loaded.project is not None, found_by(loaded)
    findings = [(finding.severity, finding.code, finding.span) for finding in loaded.diagnostics]
    assert findings == [(Severity.WARNING, rule.code, place)], found_by(loaded)


@pytest.mark.parametrize("rule", REFUSED, ids=named)
def test_this_is_refused_at_its_place(rule):
    files, place = bundle_of(rule)
    loaded = load_files(files)
    assert loaded.project is None
    errors = [finding for finding in loaded.diagnostics if finding.is_error and finding.code == rule.code]
    assert errors, found_by(loaded)
    if place.line:
        assert place in [error.span for error in errors], found_by(loaded)


# --- whole files ---


class Whole(NamedTuple):
    """`change` gives the files that are other or new (None: gone); then this is found, and nothing else."""

    title: str
    files: Mapping[str, str]
    change: Callable[[dict[str, bytes]], Mapping[str, bytes | None]]
    severity: str = ""
    code: str = ""


WHOLE_FILES = [
    Whole("carriage returns", SDL, lambda f: {n: d.replace(b"\n", b"\r\n") for n, d in f.items()}),
    Whole("carriage returns alone", JSON, lambda f: {n: d.replace(b"\n", b"\r") for n, d in f.items()}),
    Whole("a mark of the byte order", JSON, lambda f: {"go.json": b"\xef\xbb\xbf" + f["go.json"]},
          "warning", "AOS127"),
    Whole("a byte order mark", SDL, lambda f: {"go.sd": b"\xef\xbb\xbf" + f["go.sd"]}, "warning", "AOS127"),
    Whole("no newline at the end", SDL, lambda f: {"go.am": f["go.am"].rstrip()}),
    Whole("tabs for blanks", JSON, lambda f: {"go.json": f["go.json"].replace(b"    ", b"\t")}),
    Whole("blanks in a file's name", JSON, lambda f: {"my room.json": f["room.json"], "room.json": None}),
    Whole("letters of other scripts", JSON, lambda f: {
        "go.json": f["go.json"].replace(b"if (", "/* ж */ if (".encode())}),
    Whole("a second environment", JSON, lambda f: {"z.json": f["room.json"]}, "error", "AOS111"),
    Whole("a second environment of another name", JSON,
          lambda f: {"z.json": f["room.json"].replace(b'"environment"', b'"world"')}, "error", "AOS111"),
    Whole("a second skill document", JSON, lambda f: {"z.json": f["go.json"]}, "error", "AOS111"),
    Whole("a second one in SDL", JSON, lambda f: {"go.am": SDL["go.am"].encode()}, "error", "AOS111"),
    Whole("no mapping", SDL, lambda f: {"go.am": None}),
    Whole("no mapping, where others have one", SDL, lambda f: {"fly.sd": f["go.sd"]}, "remark", "AOS114"),
    Whole("no skill document", SDL, lambda f: {"go.sd": None}, "error", "AOS114"),
    Whole("no environment", SDL, lambda f: {"room.ef": None}, "error", "AOS115"),
    Whole("an empty file", SDL, lambda f: {"go.am": b" \n"}, "error", "AOS104"),
    Whole("UTF-16", SDL, lambda f: {"go.am": f["go.am"].decode().encode("utf-16")}, "error", "AOS101"),
    Whole("Latin-1", SDL, lambda f: {"go.am": f["go.am"] + b"# caf\xe9\n"}, "error", "AOS101"),
    Whole("a NUL", SDL, lambda f: {"go.am": f["go.am"] + b"\0"}, "error", "AOS101"),
    Whole("other JSON", JSON, lambda f: {"calls.json": b'{"info": {"name": "c"}}'}, "warning", "AOS107"),
    Whole("a file of another kind", JSON, lambda f: {"notes.txt": b"notes"}, "remark", "AOS107"),
    Whole("the result of a run", JSON, lambda f: {
        "run1.json": b'{"ExecutionOutcome": [{"at": "ISODate("2022")"}]}'},
          "error", "AOS107"),
    Whole("no ModuleResponse", JSON, lambda f: {
        "go glue.json": f["go glue.json"].replace(b'"ModuleResponse"', b'"Comment"'),
        "go.json": f["go.json"].replace(b"__moduleResponse = end == eWell ? eDone : eLost; ", b"")},
          "warning", "AOS133"),
    Whole("a skill's name that is none", SDL, lambda f: {
        "go there.sd": f["go.sd"], "go there.am": f["go.am"], "go.sd": None, "go.am": None},
          "error", "AOS126"),
]  # fmt: skip


def test_a_link_may_stay_in_its_bundle_and_not_lead_out_of_it(tmp_path):
    for name, text in SDL.items():
        (tmp_path / "bundle" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "bundle" / name).write_text(text)
    (tmp_path / "bundle" / "go.am").rename(tmp_path / "bundle" / ".go")
    (tmp_path / "bundle" / "go.am").symlink_to(".go")
    assert found_by(load_bundle(tmp_path / "bundle")) == []
    (tmp_path / "secret.txt").write_text("project: another")
    (tmp_path / "bundle" / "go.am").unlink()
    (tmp_path / "bundle" / "go.am").symlink_to(tmp_path / "secret.txt")
    loaded = load_bundle(tmp_path / "bundle")
    assert loaded.project is None
    (refusal,) = loaded.diagnostics
    assert (refusal.code, refusal.span, refusal.excerpt) == ("AOS120", Span("go.am"), "")


@pytest.mark.parametrize("case", WHOLE_FILES, ids=lambda case: case.title)
def test_whole_files_follow_the_rules(case):
    before = encoded(case.files)
    after = {name: data for name, data in {**before, **case.change(before)}.items() if data is not None}
    loaded = load_files(after)
    findings = {(finding.severity.value, finding.code) for finding in loaded.diagnostics}
    assert (loaded.project is None) == (case.severity == "error"), found_by(loaded)
    assert findings == ({(case.severity, case.code)} if case.severity else set()), found_by(loaded)
