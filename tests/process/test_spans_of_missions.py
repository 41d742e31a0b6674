import subprocess

from collector import collector
from gateway import environment
from places import BIN, DEPLOY, ROOT
from processes import COMMAND_S

from aos_deploy.export.kept_missions import kept_missions


def test_the_spans_of_a_mission_that_the_deploy_file_asks_for_are_all_there_at_its_end(tmp_path):
    text = (DEPLOY / "errand.yaml").read_text().replace("bundles/", f"{ROOT}/deploy/bundles/")
    with collector() as got:
        (tmp_path / "errand.yaml").write_text(f"{text}\nspans: {{otlp: '{got.address}'}}\n")
        up = subprocess.run(
            [BIN / "aos-up", "errand.yaml", "--model", "--plain", "--runs", "runs"],
            cwd=tmp_path,
            env=environment(tmp_path) | {"OTEL_EXPORTER_OTLP_HEADERS": "authorization=secret"},
            capture_output=True,
            timeout=COMMAND_S,
            check=False,
        )
    run = (tmp_path / "runs" / "latest").resolve()
    log = (run / "logs" / "spans.log").read_text()
    assert (run / "summary.json").is_file(), up.stderr.decode()
    steps = {record.step for record in kept_missions(run)[0].decisions() if record.outcome is not None}
    names = [span.name for _, span in got.spans.values()]
    assert len(steps) > 0
    assert names.count("decide") == names.count("update belief") == len(steps), log
    assert names.count("mission") == 1, log
    assert sum(name.startswith("activate ") for name in names) == len(steps)
    assert got.headers["authorization"] == "secret"
