import json

from gateway import gateway, slow_system


def test_a_system_at_an_endpoint_is_shown_followed_and_steered(tmp_path, monkeypatch):
    there, here = tmp_path / "there", tmp_path / "here"
    there.mkdir()
    here.mkdir()
    with slow_system(there, "--listen", "tcp/127.0.0.1:0") as run:
        endpoint = json.loads((run / "run.json").read_text())["endpoint"]
        monkeypatch.setenv("AOS_USER", "operator")
        monkeypatch.setenv("AOS_PASSWORD_FILE", str(run / "credentials" / "operator"))
        connected = ("--connect", endpoint, "--robot", "tiger", "--metrics")
        with gateway(here, *connected) as served:
            (entry,) = served.ask("/v1/runs").json["runs"]
            assert (entry["robot"], entry["is_running"], entry["missions"]) == ("tiger", True, [run.name])
            mission = f"/v1/missions/{run.name}"
            assert served.ask(f"{mission}/decisions/1").json["decided"]["action"] == "listen"
            assert served.ask(f"{mission}/trace").json["draws"] is False
            samples = [line for line in served.ask("/metrics").body.decode().splitlines() if line[0] != "#"]
            assert 'aos_missions_running{robot="tiger"} 1' in samples
            assert not [line for line in samples if line.startswith("aos_missions_holding")]
            with served.events(f"/v1/events?mission={run.name}&since=1") as events:
                (there / "turns").write_bytes(b".")
                observed = next(data for _, kind, data in events if kind == "decision")
                assert observed["record"]["outcome"]["status"] == "observed"
                served.post(f"{mission}/steering", {"verb": "hold", "by": "ada"})
                (there / "turns").write_bytes(b".")
                held = next(
                    data for _, kind, data in events if kind == "state" and data["phase"] == "holding"
                )
                assert held["held_by"] == "ada"
            tree = served.ask(f"{mission}/decisions/1/tree?depth=1").json
            assert tree["root"]["actions"][0]["action"] == "listen"
            assert served.ask(f"{mission}/documents").json["code"] == "AOS902"
        assert not list(here.glob("runs/*"))
    with gateway(here, *connected) as served:
        (entry,) = served.ask("/v1/runs").json["runs"]
        assert (entry["is_running"], entry["ending"]) == (False, "unreachable")
