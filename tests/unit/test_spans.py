import json
import socket
from pathlib import Path
from typing import Any

import msgspec
import pytest
from collector import Collected, collector
from decision_records import decision_record

from aos_deploy.commands.export import export
from aos_deploy.commands.machine import examine_needs
from aos_deploy.deployment.reading import read_deploy_file
from aos_deploy.processes.needed_here import check_needed_here
from aos_deploy.spans import otlp, sending
from aos_deploy.spans.otlp import Collector
from aos_deploy.spans.sending import Sender
from aos_protocol.errors import DeployError
from aos_protocol.messages import ActivationId, DecisionRecord, MissionState, Outcome
from aos_protocol.messages.base import Fault
from aos_protocol.tracing import span_id, trace_id, traceparent
from aos_runtime.disk.journal import Journal

S = 10**9


def decided(step: int) -> DecisionRecord:
    return decision_record(
        2 * step - 2,
        "a-run",
        "go",
        action="go(to=a)",
        parameters={"to": "a"},
        planning_s=0.25,
        stamp_ns=10 * step * S,
    )


def observed(step: int, status: str = "observed") -> DecisionRecord:
    fault = Fault("AOS505", "the arm is stuck") if status == "failed" else None
    outcome = Outcome(
        *(ActivationId("a-run", step), "go", status, "arrived" if fault is None else ""),
        started_ns=(10 * step + 1) * S,
        ended_ns=(10 * step + 5) * S,
        fault=fault,
    )
    done = decided(step)
    return msgspec.structs.replace(
        done,
        sequence=done.sequence + 1,
        outcome=outcome,
        surprise=0.5,
        update_s=0.5,
        stamp_ns=(10 * step + 6) * S,
    )


def end(ending: str = "goal", remark: str = "") -> MissionState:
    return MissionState("a-run", "ended", 2, 0.9, ending, remark, epoch=1)


def write(run: Path, *rows: DecisionRecord | MissionState):
    run.mkdir(exist_ok=True)
    record = {"robot": "r", "endpoint": "e", "deploy_file": "d", "seed": 1, "started": "", "pid": 1}
    (run / "run.json").write_text(json.dumps(record))
    with Journal.open(run / "journal.db") as journal:
        for row in rows:
            journal.append("decision" if isinstance(row, DecisionRecord) else "mission", row)


def told(span: Any) -> dict[str, Any]:
    kinds = ("string_value", "int_value", "double_value", "bool_value")
    return {
        each.key: next(getattr(each.value, kind) for kind in kinds if each.value.HasField(kind))
        for each in span.attributes
    }


def spans_of(got: Collected, name: str) -> list[Any]:
    return [span for _, span in got.spans.values() if span.name == name]


def test_a_mission_is_one_trace_of_its_decisions_activations_and_updates(tmp_path):
    run = tmp_path / "a-run"
    write(run, decided(1), observed(1), decided(2), observed(2, "failed"), end())
    with collector() as got:
        export([run], otlp=got.address)
    assert {(service, span.name) for service, span in got.spans.values()} == {
        *(("aos.solver", "mission"), ("aos.solver", "decide"), ("aos.solver", "update belief")),
        ("aos.middleware", "activate go"),
    }
    assert len(got.spans) == 7
    assert {span.trace_id.hex() for _, span in got.spans.values()} == {trace_id("a-run")}
    (root,) = spans_of(got, "mission")
    assert (root.span_id.hex(), root.parent_span_id) == (span_id("a-run", "mission"), b"")
    assert told(root)["aos.ending"] == "goal"
    assert {span.parent_span_id for _, span in got.spans.values()} == {b"", root.span_id}
    first = got.spans[span_id("a-run", "decision", 1)][1]
    assert first.end_time_unix_nano - first.start_time_unix_nano == S // 4
    assert told(first)["aos.step"] == 1
    good, bad = (got.spans[span_id("a-run", "activation", step)][1] for step in (1, 2))
    assert (good.start_time_unix_nano, good.end_time_unix_nano) == (11 * S, 15 * S)
    assert told(good)["aos.parameters"] == '{"to":"a"}'
    assert told(good)["aos.response"] == "arrived"
    assert good.status.code == good.status.STATUS_CODE_OK
    assert (bad.status.code, bad.status.message) == (bad.status.STATUS_CODE_ERROR, "the arm is stuck")
    assert told(got.spans[span_id("a-run", "update", 1)][1])["aos.surprise_nats"] == 0.5


def test_an_adapter_knows_the_span_of_its_call_without_being_told():
    version, trace, parent, flags = traceparent(ActivationId("a-run", 2)).split("-")
    assert (version, flags) == ("00", "01")
    assert (len(trace), len(parent)) == (32, 16)
    assert (trace, parent) == (trace_id("a-run"), span_id("a-run", "activation", 2))


def test_spans_are_sent_once_a_collector_takes_them_and_not_again(tmp_path, monkeypatch):
    monkeypatch.setattr(sending, "_BATCH", 2)
    run = tmp_path / "a-run"
    write(run, decided(1), observed(1))
    with collector() as got:
        got.status = 400
        sender = Sender(run, Collector(got.address, "r"), keeps_place=True)
        assert sender.send() == (0, False)
        got.status = 200
        assert sender.send() == (3, True)
        assert sender.send() == (0, True)
        write(run, decided(2), end("fault", "the engine has gone"))
        again = Sender(run, Collector(got.address, "r"), keeps_place=True)
        assert again.send() == (2, True)
    (root,) = spans_of(got, "mission")
    assert root.status.message == "the engine has gone"


def test_a_collector_that_is_not_there_is_an_error_that_says_what_to_do(tmp_path):
    run = tmp_path / "a-run"
    write(run, decided(1))
    with collector() as got:
        got.status = 403
        with pytest.raises(DeployError, match="does not take spans") as caught:
            export([run], otlp=got.address)
    assert "OTLP over HTTP" in caught.value.hint


def test_a_collector_where_nobody_listens_is_told_at_once(tmp_path):
    run = tmp_path / "a-run"
    write(run, decided(1))
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # Nobody listens, and nobody else takes the port.
        port = taken.getsockname()[1]
        with pytest.raises(DeployError, match=f"no collector answers at 127.0.0.1, port {port}: Conn"):
            export([run], otlp=f"http://127.0.0.1:{port}")


HEAD = "aos: 1\nrobot: rover\nbundles: [bundle]\n"


@pytest.fixture
def deploy_file(tmp_path) -> Path:
    (tmp_path / "bundle").mkdir()
    (tmp_path / "bundle" / "rover.ef").write_text("")
    path = tmp_path / "rover.yaml"
    path.write_text(HEAD + "spans: {otlp: 'http://127.0.0.1:4318'}\n")
    return path


def test_a_missing_package_is_told_with_what_to_type(deploy_file: Path, monkeypatch):
    monkeypatch.setattr(otlp, "_NEEDS", ("opentelemetry_that_nobody_has.sdk",))
    with pytest.raises(DeployError) as caught:
        check_needed_here(read_deploy_file(deploy_file))
    assert caught.value.code == "AOS805"
    assert caught.value.hint == "Run pip install 'aos-autonomy[otel]'"
    (finding,) = (each for each in examine_needs(deploy_file) if each.subject == "spans")
    assert (finding.state, finding.advice) == ("missing", caught.value.hint)


@pytest.mark.parametrize("address", ["localhost:4318", "grpc://here:4317", "http://", "http://[", "file:x"])
def test_an_address_that_is_no_collectors_is_told_at_its_place(deploy_file: Path, address):
    deploy_file.write_text(HEAD + f"spans:\n  otlp: '{address}'\n")
    with pytest.raises(DeployError) as caught:
        read_deploy_file(deploy_file)
    (found,) = caught.value.diagnostics
    assert (found.code, found.span.line, found.span.column) == ("AOS106", 5, 9)
    assert found.message == f"{address!r} is no collector's address"
