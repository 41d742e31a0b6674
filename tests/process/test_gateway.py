import asyncio
import io
import json
import os
import re
import signal
import subprocess
import sys
import zipfile
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest
from gateway import Gateway, gateway, played, worn_system
from places import ROOT
from processes import HANG_S, finished

from aos_deploy.export.run_bundle import write_bundle
from aos_gateway.server import Use

ERRAND = "deploy/bundles/errand"


def archive(folder: Path, **changed: str) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as file:
        for path in sorted(folder.iterdir()):
            file.writestr(path.name, changed.get(path.stem, path.read_text()))
    return packed.getvalue()


def test_a_run_and_its_mission_are_listed(past: tuple[Gateway, str]):
    served, name = past
    (run,) = served.ask("/v1/runs").json["runs"]
    assert (run["run"], run["robot"], run["is_running"], run["ending"]) == (name, "errand", False, "goal")
    (mission,) = served.ask("/v1/missions").json["missions"]
    assert mission["mission"]["ending"] == mission["state"]["ending"] == "goal"
    assert mission["summary"]["steps"] == mission["mission"]["steps"]
    assert served.ask(f"/v1/runs/{name}").json == run


def test_decisions_beliefs_activations_and_trace_tell_of_the_same_steps(past: tuple[Gateway, str]):
    served, name = past
    path = f"/v1/missions/{name}"
    records = served.ask(f"{path}/decisions").json["records"]
    trace = served.ask(f"{path}/trace").json
    assert [row["action"] for row in trace["steps"]] == [record["action"] for record in records[::2]]
    assert trace["next"] == len(records)
    beliefs = served.ask(f"{path}/beliefs?limit=2").json
    assert [each["belief"] for each in beliefs["beliefs"]] == [record["belief"] for record in records[:2]]
    assert (beliefs["has_more"], beliefs["next"]) == (True, 2)
    activations = served.ask(f"{path}/activations").json["activations"]
    assert [each["outcome"] for each in activations] == [record["outcome"] for record in records[1::2]]
    last = served.ask(f"{path}/decisions/{len(activations)}").json
    assert (last["decided"], last["observed"]) == (records[-2], records[-1])


def test_a_past_decision_is_explained_and_made_anew_under_other_circumstances(past: tuple[Gateway, str]):
    served, name = past
    path = f"/v1/missions/{name}/decisions/2"
    decided = served.ask(path).json["decided"]
    why = served.ask(f"{path}/why").json
    assert (why["action"], why["step"]) == (decided["action"], 2)
    assert sum(each["probability"] for each in why["expected"]) == pytest.approx(1)
    other = served.post(f"{path}/whatif", {"forbid": [decided["action"]]}).json
    assert other["before"] == decided["action"] != other["action"]
    unknown = served.ask(f"{path}/why?instead=fly")
    assert (unknown.status, unknown.json["code"]) == (404, "AOS501")


def test_a_run_that_somebody_has_sent_is_shown(past: tuple[Gateway, str], tmp_path):
    served, name = past
    file = tmp_path / "sent.aosrun"
    write_bundle([served.folder / "runs" / name], file)
    with gateway(tmp_path, str(file)) as other:
        (run,) = other.ask("/v1/runs").json["runs"]
        assert (run["run"], run["ending"]) == (name, "goal")
        path = f"/v1/missions/{name}/trace"
        assert other.ask(path).json == served.ask(path).json


def test_a_mission_tells_the_address_of_its_page(tmp_path):
    said = tmp_path / "said"
    run = played(tmp_path, "--page", said=said)
    note = json.loads((tmp_path / "gateway/gateway.json").read_text())
    try:
        found = re.search(
            r"^page (http://127\.0\.0\.1:\d+/)#/runs/(.+)\?token=(\S+)$", said.read_text(), re.M
        )
        assert found is not None
        assert (found[1], found[2]) == (note["address"], run.name)
        port = int(found[1].rstrip("/").rpartition(":")[2])
        connection = HTTPConnection("127.0.0.1", port, timeout=HANG_S)
        connection.request("GET", f"/v1/missions/{run.name}", headers={"authorization": f"Bearer {found[3]}"})
        assert json.loads(connection.getresponse().read())["state"]["ending"] == "goal"
        connection.close()
    finally:
        os.kill(note["pid"], signal.SIGTERM)


def test_a_gateway_ends_by_itself_once_nobody_looks(tmp_path):
    with gateway(tmp_path, "--unused", "0.2") as served:
        assert served.process.wait(timeout=HANG_S) == 0


async def test_a_gateway_is_in_use_as_long_as_somebody_looks():
    is_read = asyncio.Event()
    use = Use(lambda *request: is_read.wait())
    look = asyncio.create_task(use({}, None, None))
    ended = asyncio.create_task(use.until_unused(0.01))
    await asyncio.wait([ended], timeout=0.2)
    assert not ended.done()
    is_read.set()
    async with asyncio.timeout(HANG_S):
        await asyncio.gather(look, ended)


def test_a_gateway_of_another_folder_shows_a_run_that_asks_for_its_page(tmp_path):
    with gateway(tmp_path, "--runs", str(tmp_path / "others")) as served:
        run = played(tmp_path, "--page")
        assert served.ask(f"/v1/missions/{run.name}").json["state"]["ending"] == "goal"


def test_the_state_is_drawn_as_the_documents_say(past: tuple[Gateway, str]):
    served, name = past
    assert served.ask(f"/v1/missions/{name}/trace").json["draws"] is True
    drawn = served.ask(f"/v1/missions/{name}/decisions/1/picture")
    assert (drawn.status, drawn.headers["content-type"]) == (200, "image/svg+xml")
    assert "sandbox" in drawn.headers["content-security-policy"]
    assert b">alice</text>" in drawn.body
    assert served.ask(f"/v1/missions/{name}/decisions/999/picture").json["code"] == "AOS902"


def test_documents_come_with_the_lines_of_each_skill(past: tuple[Gateway, str]):
    served, name = past
    found = served.ask(f"/v1/missions/{name}/documents").json
    texts = {file["name"]: file["text"].splitlines() for file in found["files"]}
    assert found["skills"]
    for skill, lines in found["skills"].items():
        model = next(each for each in lines if each["what"] == "model")
        assert model["file"] == f"{skill}.sd"
        assert 1 <= model["first"] <= model["last"] <= len(texts[model["file"]]) + 1


def test_a_past_mission_is_streamed_from_a_record_on_with_its_end(past: tuple[Gateway, str]):
    served, name = past
    count = served.ask(f"/v1/missions/{name}/trace").json["next"]
    with served.events(f"/v1/events?mission={name}", last=f"{name}:{count - 2}") as events:
        told = [next(events) for _ in range(3)]
    assert [kind for _, kind, _ in told] == ["decision", "decision", "state"]
    assert told[-1][2]["ending"] == "goal"
    assert [event_id for event_id, _, _ in told] == [
        f"{name}:{number}" for number in (count - 1, count, count)
    ]


def test_the_example_follows_the_latest_mission_to_its_end(past: tuple[Gateway, str]):
    served, name = past
    example = [sys.executable, ROOT / "docs/examples/follow_events.py", f"http://127.0.0.1:{served.port}"]
    with_token = os.environ | {"TOKEN": served.token}
    told = finished(*example, env=with_token).stdout
    records = served.ask(f"/v1/missions/{name}/decisions").json["records"]
    response = records[1]["outcome"]["response"]
    assert told.splitlines()[:2] == [f"step 1: {records[0]['action']}", f"step 1: {response}"]
    assert told.splitlines()[-1] == "ended: goal"
    without = os.environ | {"TOKEN": ""}
    lone = finished(*example, env=without)
    assert (lone.returncode, lone.stderr[:8]) == (1, "AOS903: ")
    read_end, write_end = os.pipe()
    os.close(read_end)
    piped = subprocess.run(example, env=with_token, stdout=write_end, stderr=subprocess.PIPE, check=False)
    os.close(write_end)
    assert (piped.returncode, piped.stderr) == (-signal.SIGPIPE, b"")
    assert served.ask("/v1/missions/latest/decisions").json["records"] == records
    assert served.ask("/v1/runs/latest").json["run"] == name


def test_logs_are_read_of_services_alone(past: tuple[Gateway, str]):
    served, name = past
    services = {each["service"] for each in served.ask(f"/v1/runs/{name}/services").json["services"]}
    assert {"router", "registry", "middleware", "solver"} <= services
    log = served.ask(f"/v1/runs/{name}/logs/solver?tail=1000")
    assert (log.status, log.headers["content-type"]) == (200, "text/plain; charset=utf-8")
    assert b"solver" in log.body
    assert served.ask(f"/v1/runs/{name}/logs/..%2Fjournal.db").status == 404


@pytest.mark.parametrize(
    ("path", "status", "code"),
    [
        ("/v1/runs/nothing", 404, "AOS902"),
        ("/v1/missions/nothing", 404, "AOS902"),
        ("/v1/missions/{name}/decisions/999", 404, "AOS902"),
        ("/v1/missions/{name}/decisions/x", 400, "AOS901"),
        ("/v1/missions/{name}/decisions?limit=0", 400, "AOS901"),
        ("/v1/missions/{name}/decisions?limit=x", 400, "AOS901"),
        ("/v1/missions/{name}/decisions?colour=red", 400, "AOS901"),
        ("/v1/missions/{name}/documents?revision=99", 404, "AOS902"),
        ("/v1/missions/{name}/world/1", 404, "AOS902"),
        ("/v1/nothing", 404, "AOS902"),
    ],
)
def test_what_cannot_be_answered_is_a_problem(past: tuple[Gateway, str], path, status, code):
    served, name = past
    answer = served.ask(path.format(name=name))
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.status, answer.json["status"], answer.json["code"]) == (status, status, code)
    assert answer.json["type"] == f"urn:aos:{code}"


def test_misspelt_fields_other_methods_and_large_bodies_are_told_and_start_nothing(past: tuple[Gateway, str]):
    served, name = past
    for path, body in (
        ("/v1/runs", {"project": "errand", "modell": True}),
        (f"/v1/missions/{name}/steering", {"verb": "act", "action": ["look"]}),
    ):
        refused = served.post(path, body)
        assert (refused.status, refused.json["code"]) == (400, "AOS901")
        assert "unknown field" in refused.json["detail"]
    answer = served.ask("/v1/runs", method="PUT")
    assert (answer.status, answer.headers["allow"]) == (405, "GET, HEAD, POST")
    assert answer.json["hint"] == "It has GET, HEAD, POST"
    answer = served.ask("/v1/checks?name=a.zip", method="POST", body=bytes(2**24 + 1))
    assert (answer.status, answer.json["code"]) == (413, "AOS901")


def test_a_mission_that_is_over_is_neither_stopped_nor_steered(past: tuple[Gateway, str]):
    served, name = past
    for answer in (
        served.post(f"/v1/missions/{name}/stop"),
        served.post(f"/v1/missions/{name}/steering", {"verb": "hold"}),
        served.post(f"/v1/runs/{name}/missions"),
        served.post(f"/v1/runs/{name}/stop"),
    ):
        assert (answer.status, answer.json["code"]) == (409, "AOS905")
    assert served.ask(f"/v1/missions/{name}/documents?revision={2**40}").status == 400


def test_strangers_are_refused(past: tuple[Gateway, str]):
    served, name = past
    refusals = [
        served.ask("/v1/runs", headers={"host": "evil.example"}),
        served.ask("/", headers={"host": "evil.example"}),
        served.ask("/v1/runs", headers={"origin": "http://evil.example"}),
        served.ask(f"/v1/missions/{name}/stop", "POST", has_token=False),
        served.ask(f"/v1/missions/{name}", has_token=False),
    ]
    assert [(each.status, each.json["code"]) for each in refusals] == [
        (403, "AOS904"),
        (403, "AOS904"),
        (403, "AOS904"),
        (401, "AOS903"),
        (401, "AOS903"),
    ]
    assert refusals[-1].headers["www-authenticate"] == "Bearer"


def test_openapi_describes_every_operation_with_schemas_that_are_there(past: tuple[Gateway, str]):
    served, _ = past
    document = served.ask("/v1/openapi.json").json
    assert document["openapi"] == "3.1.0"
    references: list[str] = []

    def look(value: Any):
        if isinstance(value, dict):
            references.extend([value["$ref"]] if "$ref" in value else [])
            for each in value.values():
                look(each)
        elif isinstance(value, list):
            for each in value:
                look(each)

    look(document)
    assert "DecisionRecord" in document["components"]["schemas"]
    for reference in references:
        assert reference.removeprefix("#/components/schemas/") in document["components"]["schemas"]
    writes = [one for path in document["paths"].values() for method, one in path.items() if method != "get"]
    assert all(one["security"] == [{"token": []}] for one in writes)


def test_a_bundle_is_checked_with_the_place_of_each_finding(past: tuple[Gateway, str]):
    served, _ = past
    good = served.ask("/v1/checks?name=errand.zip", "POST", archive(ROOT / ERRAND)).json
    assert (good["is_accepted"], good["project"]) == (True, "errand")
    broken = archive(ROOT / ERRAND, errand="project: errand\nhorizon: many\n")
    bad = served.ask("/v1/checks?name=errand.zip", "POST", broken).json
    assert not bad["is_accepted"]
    assert any(found["span"]["file"] == "errand.ef" and found["span"]["line"] for found in bad["diagnostics"])


def test_an_upload_that_is_no_bundle_is_refused_and_nothing_is_kept(past: tuple[Gateway, str]):
    served, _ = past
    before = served.ask("/v1/projects").json
    for name, body in (
        ("a.zip", b"no archive"),
        ("a.exe", b"x"),
        ("a.sd", b"project: p\n"),
        ("..%2F..%2Fa.sd", b""),
    ):
        answer = served.ask(f"/v1/projects?name={name}", "POST", body)
        assert (answer.status, answer.headers["content-type"]) == (422, "application/problem+json")
    assert served.ask("/v1/projects").json == before


def test_a_mission_is_started_from_an_uploaded_bundle_and_ends_as_one_from_a_terminal(
    past: tuple[Gateway, str],
):
    served, _ = past
    kept = served.ask("/v1/projects?name=errand.zip", "POST", archive(ROOT / ERRAND))
    assert kept.status == 201
    started = served.post(
        "/v1/runs", {"project": kept.json["project"], "seed": 3, "values": {"target": "alice"}}
    )
    assert started.status == 201
    with served.events(f"/v1/events?mission={started.json['mission']}") as events:
        end = next(data for _, kind, data in events if kind == "state" and data["phase"] == "ended")
    assert end["ending"] == "goal"


def test_a_deploy_file_that_is_wrong_is_refused_with_its_place(past: tuple[Gateway, str], tmp_path):
    served, _ = past
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text("aos: 1\nrobot: r\nbundles: [nothing]\n")
    answer = served.post("/v1/runs", {"deploy_file": str(wrong)})
    assert (answer.status, answer.json["code"]) == (422, "AOS801")
    assert ":3:" in answer.json["place"]


def test_whoever_views_a_living_mission_is_told_what_happens_steers_it_and_can_stop_it(
    living: tuple[Gateway, Path],
):
    served, run = living
    path, stream = f"/v1/missions/{run.name}", f"/v1/events?mission={run.name}"
    turns = run.parents[1] / "turns"
    with served.events(stream) as events:
        seen = [next(events)]
        while {"state", "service"} - {kind for _, kind, _ in seen}:
            seen.append(next(events))
        last, _, first = next(each for each in seen if each[1] == "decision")
        assert (first["row"]["action"], first["record"]["sequence"]) == ("listen", 0)
        turns.write_bytes(b".")
        outcome = next(data for _, kind, data in events if kind == "decision" and "outcome" in data["record"])
        assert outcome["record"]["outcome"]["response"] == "tiger_left"

    # A stream that comes back gets each record once, also from a gateway that was started again.
    with gateway(served.folder) as again, again.events(stream, last=last) as events:
        decisions = (data["record"]["sequence"] for _, kind, data in events if kind == "decision")
        assert [next(decisions) for _ in range(2)] == [1, 2]

    held = served.post(f"{path}/steering", {"verb": "hold", "by": "ada"})
    assert (held.status, held.json["held_by"]) == (200, "ada")
    with served.events(stream) as events:
        turns.write_bytes(b".")
        next(data for _, kind, data in events if kind == "state" and data["phase"] == "holding")
        asked = served.post(f"{path}/steering", {"verb": "act", "actions": ["listen"]})
        assert asked.status == 200
        row = next(data["row"] for _, kind, data in events if kind == "decision" and data["row"]["step"] == 3)
        assert row["chosen_by"] == "operator"
        refused = served.post(f"{path}/steering", {"verb": "act", "actions": ["fly"]})
        assert (refused.status, refused.json["code"]) == (409, "AOS517")
        assert served.post(f"{path}/steering", {"verb": "dance"}).status == 400
        stopped = served.post(f"{path}/stop")
        assert (stopped.status, stopped.json["ending"]) == (200, "cancelled")
        end = next(data for _, kind, data in events if kind == "state" and data["phase"] == "ended")
    assert end["ending"] == "cancelled"


def test_the_next_mission_of_a_system_that_stays_begins_with_what_is_asked_for(tmp_path):
    with worn_system(tmp_path) as run, gateway(tmp_path) as served:
        path = f"/v1/runs/{run.name}/missions"
        assert served.ask(f"/v1/runs/{run.name}").json["ending"] == "waiting"
        assert served.ask(f"/v1/missions/{run.name}-1").json["parameters"] == {"room": "hall"}
        refused = served.post(path, {"given": ["state.is_lit == maybe"]})
        assert (refused.status, refused.json["code"]) == (422, "AOS110")
        impossible = served.post(path, {"given": ["state.is_lit"]})
        assert (impossible.status, impossible.json["code"]) == (422, "AOS516")
        wish = {"belief": "keep", "idle": 2, "given": ["!state.is_lit"], "values": {"room": "lab"}}
        begun = served.post(path, wish)
        assert (begun.status, begun.json["mission"]) == (201, f"{run.name}-2")
        with served.events(f"/v1/events?mission={run.name}-2") as events:
            first = next(data for _, kind, data in events if kind == "decision")
            next(data for _, kind, data in events if kind == "state" and data["phase"] == "ended")
        assert first["row"]["action"] == "press(room=lab)"
        view = served.ask(f"/v1/missions/{run.name}-2").json
        assert {name: view["mission"][name] for name in wish} == wish
        assert view["parameters"] == {"room": "lab"}
        ended = served.post(f"/v1/runs/{run.name}/stop")
        assert (ended.status, ended.json["ending"]) == (200, "stopped")
