from pathlib import Path

from typer.testing import CliRunner, Result

from aos_deploy.cli import aos_app


def aos(*arguments: str | Path) -> Result:
    words = [str(argument) for argument in arguments]
    return CliRunner().invoke(aos_app(words), words)
