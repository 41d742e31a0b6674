from pathlib import Path

import pytest
from places import DEPLOY

from aos_deploy.deployment.reading import Deployment, read_deploy_file
from aos_protocol.errors import DeployError

HEAD = "aos: 1\nrobot: rover\nbundles: [bundle]\n"


def world_without_pictures(folder: Path) -> Path:
    path = folder / "world.yaml"
    path.write_text((DEPLOY / "worlds/armadillo.yaml").read_text() + "pictures: false\n")
    return path


def read(folder: Path, text: str) -> Deployment:
    (folder / "rover.yaml").write_text(text)
    return read_deploy_file(folder / "rover.yaml")


def findings(folder: Path, text: str) -> list[str]:
    with pytest.raises(DeployError) as caught:
        read(folder, text)
    assert caught.value.code == "AOS801"
    return [
        f"{finding.span.line}:{finding.span.column} {finding.code} {finding.message}"
        + (f". {finding.hint}" if finding.hint else "")
        for finding in caught.value.diagnostics
    ]
