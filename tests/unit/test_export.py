import base64
import csv
import json
import random
import sqlite3
import sys
import zipfile
import zlib
from contextlib import closing
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import jsonschema_rs
import msgspec
import pytest
from decision_records import decision_record

from aos_deploy.cli import main
from aos_deploy.commands.export import export
from aos_deploy.export.kept_missions import kept_missions
from aos_deploy.export.layouts import curves_of, foxglove_layout, plotjuggler_layout
from aos_deploy.export.run_bundle import opened_bundle, write_bundle
from aos_deploy.history_check.files import check_run
from aos_deploy.runs.living import chosen_run, chosen_runs
from aos_protocol.errors import DeployError
from aos_protocol.messages import (
    ActionValue,
    Activate,
    ActivationId,
    BeliefSummary,
    Cancel,
    DecisionRecord,
    Fault,
    Marginal,
    MissionState,
    Outcome,
    PredictedObservation,
    Steer,
)
from aos_runtime.disk.journal import Journal

replace = msgspec.structs.replace
STEPS = 3
PICTURE = b"\x89PNG\r\n\x1a\n of step 2"
PASSWORD = "kf83jd92kd03"


def belief(step: int) -> BeliefSummary:
    marginal = Marginal("cans[0].where", {"Left": step / 10, "Right": 1 - step / 10})
    depth = Marginal("depth", {"1.5": 0.01}, 0.99, (0.5, 1.0, step / 10, 2.0, 2.5))
    return BeliefSummary((marginal, depth), 0.5, step / 10, 0.0, 2, True)


def decided(step: int) -> DecisionRecord:
    return decision_record(
        2 * step - 2,
        "a-run",
        "go",
        step=step,
        action="go(to=a)",
        parameters={"to": "a"},
        actions=(
            ActionValue("go(to=a)", 1.5 * step, 100, 0.1, at_most=float("inf")),
            ActionValue("look", -1.0, 50, 0.2),
        ),
        predicted=(PredictedObservation("arrived", 0.75), PredictedObservation("lost", 0.25)),
        belief=belief(step - 1),
        stamp_ns=1_000_000_000 * step,
    )


def make_run(folder: Path) -> Path:
    run = folder / "a-run"
    for inner in ("logs", "pictures", "credentials", "settings"):
        (run / inner).mkdir(parents=True)
    record = {"robot": "r", "endpoint": "e", "deploy_file": "d", "seed": 1, "started": "", "pid": 1}
    (run / "run.json").write_text(json.dumps(record))
    (run / "pictures" / "step-002.png").write_bytes(PICTURE)
    (run / "credentials" / "solver").write_text(PASSWORD)
    (run / "settings" / "other.json").write_text(json.dumps({"with": PASSWORD}))
    (run / "logs" / "solver.log").write_text("it has begun\n")
    (run / "bus").symlink_to("/dev/null")
    with Journal.open(run / "journal.db") as journal:
        for step in range(1, STEPS + 1):
            outcome = Outcome(
                *(ActivationId("a-run", step), "go", "observed", "arrived"),
                ended_ns=step * 10**9 + 5,
                fault=Fault("AOS510", "it slips") if step == 2 else None,
            )
            journal.append("decision", decided(step))
            journal.append("intended", Activate(outcome.id, "go", {"to": "a"}, 10.0, 1))
            journal.append("outcome", outcome)
            done = replace(
                decided(step), sequence=2 * step - 1, outcome=outcome, belief=belief(step), surprise=0.29
            )
            journal.append("decision", done)
        journal.append("steered", Steer("hold", by="ana", request="1"))
        journal.append("of_a_later_version", Steer("hold"))
        end = MissionState("a-run", "ended", STEPS, 0.3, "goal", revision=1, epoch=1)
        journal.append("mission", end)
    return run


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("AOS_CACHE_DIR", str(tmp_path / "cache"))


@pytest.fixture
def run(tmp_path) -> Path:
    return make_run(tmp_path)


def messages_of(file: Path) -> list[tuple[str, dict[str, Any], Any, int]]:
    reader = pytest.importorskip("mcap.reader", reason="set up before mcap was among the dependencies")
    with file.open("rb") as stream:
        return [
            (channel.topic, json.loads(schema.data), json.loads(message.data), message.log_time)
            for schema, channel, message in reader.make_reader(stream).iter_messages()
        ]


def test_a_run_is_read_back_from_its_mcap_file(run: Path, tmp_path):
    target = tmp_path / "out.mcap"
    pytest.importorskip("mcap", reason="set up before mcap was among the dependencies")
    export([run], "mcap", target)
    messages = messages_of(target)
    by_topic: dict[str, list[Any]] = {}
    for topic, schema, content, _ in messages:
        jsonschema_rs.validate(schema, content)
        assert schema["type"] == "object"
        assert "$ref" not in json.dumps(schema)
        by_topic.setdefault(topic, []).append(content)
    rows = list(kept_missions(run)[0].rows())
    assert len(by_topic["/aos/decision"]) == 2 * STEPS
    assert {topic for topic in by_topic if len(by_topic[topic]) == 1} == {
        *("/aos/mission", "/aos/steered", "/aos/of_a_later_version", "/aos/picture")
    }
    added = ("/aos/plot/belief", "/aos/plot/values", "/aos/picture")
    assert sum(topic not in added for topic, *_ in messages) == len(rows)
    first = msgspec.convert(by_topic["/aos/decision"][0], DecisionRecord)
    assert (first.action, first.belief) == ("go(to=a)", belief(0))
    assert by_topic["/aos/plot/values"][1]["q"] == {"go_to_a": 3.0, "look": -1.0}
    assert by_topic["/aos/plot/belief"][-1]["probability"]["cans_0_where"] == {"Left": 0.3, "Right": 0.7}
    assert by_topic["/aos/plot/belief"][-1]["quantiles"]["depth"] == {
        **{"p05": 0.5, "p25": 1.0, "p50": 0.3, "p75": 2.0, "p95": 2.5}
    }
    (picture,) = by_topic["/aos/picture"]
    assert base64.b64decode(picture["data"]) == PICTURE
    assert [stamp for topic, _, _, stamp in messages if topic == "/aos/picture"] == [2 * 10**9 + 5]


def test_layouts_show_only_what_is_in_the_file(run: Path, tmp_path):
    pytest.importorskip("mcap", reason="set up before mcap was among the dependencies")
    export([run], "mcap", tmp_path)
    messages = messages_of(tmp_path / "a-run.mcap")
    fields = {topic for topic, *_ in messages}
    for topic, _, content, _ in messages:
        fields |= set(paths_in(topic, content))
    layout = json.loads((tmp_path / "a-run.foxglove.json").read_text())
    shown = [path["value"] for panel in layout["configById"].values() for path in panel.get("paths", ())]
    assert {path for path in shown if path.startswith("/aos/plot/belief.probability")} == {
        *("/aos/plot/belief.probability.cans_0_where.Left", "/aos/plot/belief.probability.cans_0_where.Right")
    }
    assert "/aos/plot/belief.quantiles.depth.p50" in shown
    assert set(shown) <= fields
    assert set(panels_in(layout["layout"])) == layout["configById"].keys()
    assert layout["configById"]["Image!aos"]["imageMode"]["imageTopic"] in fields
    curves = ET.parse(tmp_path / "a-run.plotjuggler.xml").getroot().iter("curve")
    names = [curve.get("name", "") for curve in curves]
    assert len(names) > 5
    assert {name.replace("/", ".") for name in names} <= {field.replace("/", ".") for field in fields}


def paths_in(prefix: str, content: Any) -> list[str]:
    if not isinstance(content, dict):
        return [prefix]
    return [path for name, value in content.items() for path in paths_in(f"{prefix}.{name}", value)]


def panels_in(layout: Any) -> list[str]:
    if isinstance(layout, str):
        return [layout]
    return [*panels_in(layout["first"]), *panels_in(layout["second"])]


def test_a_run_without_steps_has_layouts():
    curves = curves_of([])
    assert foxglove_layout(curves, has_pictures=False)["layout"]
    assert plotjuggler_layout(curves).startswith("<?xml")


def test_tables_hold_each_step_prediction_value_and_belief(run: Path, tmp_path):
    export([run], "csv", tmp_path / "tables")
    tables = {
        path.stem: list(csv.DictReader(path.read_text().splitlines()))
        for path in (tmp_path / "tables").glob("*.csv")
    }
    assert {name: len(rows) for name, rows in tables.items()} == {
        "missions": 1,
        "steps": STEPS,
        "values": 2 * STEPS,
        "predictions": 2 * STEPS,
        "beliefs": 6 * STEPS,
        "quantiles": 10 * STEPS,
    }
    third = tables["quantiles"][2]
    assert (third["variable"], third["probability"], third["value"]) == ("depth", "0.5", "0.0")
    step = tables["steps"][1]
    told = [step[name] for name in ("step", "action", "response", "error", "chosen_by")]
    assert told == ["2", "go(to=a)", "arrived", "AOS510: it slips", "planner"]
    assert json.loads(step["parameters"]) == {"to": "a"}
    assert (tables["missions"][0]["ending"], tables["missions"][0]["steps"]) == ("goal", "3")
    assert [(row["response"], row["is_seen"]) for row in tables["predictions"][:2]] == [
        ("arrived", "True"),
        ("lost", "False"),
    ]


def test_parquet_has_the_same_tables_with_types(run: Path, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="the extra `parquet` is not installed")
    export([run, make_run(tmp_path / "other")], "parquet", tmp_path / "tables")
    steps = parquet.read_table(tmp_path / "tables" / "steps.parquet").to_pylist()
    assert [row["step"] for row in steps] == [1, 2, 3, 1, 2, 3]
    assert steps[0]["surprise"] == pytest.approx(0.29)
    assert steps[0]["is_impossible"] is False
    values = parquet.read_table(tmp_path / "tables" / "values.parquet")
    assert str(values.schema.field("q").type) == "double"


def test_a_file_of_a_run_is_opened_like_its_directory_and_lets_nobody_in(run: Path, tmp_path):
    target = tmp_path / "sent.aosrun"
    export([run], "bundle", target)
    with zipfile.ZipFile(target) as archive:
        names = archive.namelist()
        assert PASSWORD.encode() not in b"".join(archive.read(name) for name in names)
    assert {name.removeprefix("a-run/") for name in names} == {
        *("run.json", "journal.db", "logs/solver.log", "pictures/step-002.png")
    }
    opened = chosen_run(target, None)
    assert (opened.path.name, opened.named) == ("a-run", target)
    assert not opened.is_running
    assert check_run(opened.path).violations == check_run(run).violations
    before = [row.payload for row in kept_missions(run)[0].rows()]
    assert [row.payload for row in kept_missions(opened.path)[0].rows()] == before


def test_a_file_of_several_runs_names_them(run: Path, tmp_path):
    other = make_run(tmp_path / "other")
    other = other.rename(other.with_name("b-run"))
    target = tmp_path / "sent.aosrun"
    write_bundle([run, other], target)
    assert [path.name for path in opened_bundle(target)] == ["a-run", "b-run"]
    with pytest.raises(DeployError, match="has 2 runs") as raised:
        chosen_run(target, None)
    folder = opened_bundle(target)[0].parent
    assert raised.value.hint == f"Name one in {folder}. The newest there: a-run, b-run"


def test_a_link_in_a_file_is_refused_and_so_is_what_is_no_archive(tmp_path):
    target = tmp_path / "bad.aosrun"
    link = zipfile.ZipInfo("a-run/run.json")
    link.external_attr = 0o120777 << 16
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr(link, "/etc/passwd")
    with pytest.raises(DeployError, match="is not a plain file within it"):
        opened_bundle(target)
    target.write_text("no archive")
    with pytest.raises(DeployError, match="is not a file of runs"):
        opened_bundle(target)
    with pytest.raises(DeployError, match="is a folder") as refused:
        opened_bundle(tmp_path)
    assert refused.value.hint.endswith(f"--runs {tmp_path}")


def test_a_run_that_is_named_twice_is_taken_once(tmp_path):
    runs = [make_run(tmp_path / name) for name in ("a", "b")]
    (tmp_path / "latest").symlink_to(runs[1])
    assert chosen_runs([*runs, tmp_path / "latest"], None) == runs
    assert chosen_runs([tmp_path / "latest", *runs], None) == [tmp_path / "latest", runs[0]]


def test_a_folder_of_runs_names_all_of_them(tmp_path):
    (tmp_path / "runs").mkdir()
    runs = [make_run(tmp_path / name).rename(tmp_path / "runs" / name) for name in ("b", "a")]
    (tmp_path / "runs" / "latest").symlink_to(runs[0])
    (tmp_path / "runs" / "other").mkdir()
    assert chosen_runs([tmp_path / "runs"], None) == [runs[1], runs[0]]
    with pytest.raises(DeployError, match="is not a run directory"):
        chosen_runs([tmp_path / "runs" / "other"], None)
    with pytest.raises(DeployError, match="not a run") as refused:
        chosen_runs([tmp_path], None)
    assert refused.value.hint == f"Its runs are in {tmp_path / 'runs'}"
    (runs[0] / "missions" / "2").mkdir(parents=True)
    with pytest.raises(DeployError, match="not a run") as refused:
        chosen_runs([runs[0] / "missions" / "2"], None)
    assert f"Name {runs[0]} instead, and --mission 2" in refused.value.hint


def test_a_file_that_was_damaged_on_its_way_is_opened_or_refused(run: Path, tmp_path):
    target = tmp_path / "sent.aosrun"
    write_bundle([run], target)
    good = target.read_bytes()
    chance = random.Random(20261126)
    refused = 0
    for _ in range(150):
        raw = bytearray(good)
        for _ in range(chance.randint(1, 6)):
            place = chance.choice((chance.randrange(len(raw)), len(raw) - chance.randint(1, 600)))
            raw[place] = chance.randrange(256)
        target.write_bytes(raw)
        try:
            opened_bundle(target)
        except DeployError:
            refused += 1
    assert refused > 50


def test_a_record_that_is_nested_without_end_is_told_as_unreadable(run: Path, tmp_path, monkeypatch, capsys):
    with Journal.open(run / "journal.db") as journal:
        journal.append("decision", Cancel("x"))
    with closing(sqlite3.connect(run / "journal.db")) as connection:
        (seq, stamp_ns) = connection.execute("SELECT max(seq), max(stamp_ns) FROM entries").fetchone()
        text = '{"x":' + "[" * 200_000 + "]" * 200_000 + "}"
        connection.execute("DROP TRIGGER entries_stay")
        checksum = zlib.crc32(f"{stamp_ns} decision {text}".encode())
        values = (stamp_ns, text, checksum, seq)
        connection.execute("UPDATE entries SET stamp_ns = ?, payload = ?, checksum = ? WHERE seq = ?", values)
        connection.commit()
    monkeypatch.setattr(
        sys, "argv", ["aos", "export", str(run), "-o", str(tmp_path / "x"), "--format", "csv"]
    )
    with pytest.raises(SystemExit):
        main()
    assert "AOS702" in capsys.readouterr().err
