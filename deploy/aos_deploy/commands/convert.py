"""`aos convert`: a bundle's documents in the other dialect."""

from pathlib import Path
from typing import Annotated

import typer

from aos_deploy.bundles.files import planned_of, refusal
from aos_deploy.commands.documents import FolderOrDeployFile
from aos_deploy.options import command
from aos_deploy.printing import count, print_diagnostics
from aos_language.convert import Dialect, convert
from aos_protocol.diagnostics import has_errors
from aos_protocol.errors import DocumentError


@command("Example: aos convert deploy/bundles/armadillo-finer --to json --out converted", "convert")
def convert_bundle(
    path: FolderOrDeployFile,
    dialect: Annotated[Dialect, typer.Option("--to", help="The dialect to write")],
    out: Annotated[
        Path | None, typer.Option("--out", help="A new directory; without it BUNDLE-sdl or BUNDLE-json here")
    ] = None,
) -> None:
    """Write a bundle's documents in SDL or in AOS 1.x JSON.

    Each document is read again and compared with the original before anything is written. Comments in code
    stay; those elsewhere, and the order of sections, do not. The bundle itself is left as it is. The
    bundles of a deploy file become one.
    """
    planned = planned_of(path)
    texts, found = convert(planned.files, dialect)
    found = (*planned.remarks, *found)
    if has_errors(found):
        raise refusal(path, found)
    if not texts:
        hint = "A bundle is a directory with documents"
        raise DocumentError(f"there are no documents in {path}", code="AOS120", hint=hint, diagnostics=found)
    print_diagnostics(found)
    folder = out or Path(f"{path.resolve().stem}-{dialect.value}")
    _write(folder, texts)
    typer.echo(f"{folder}: {count(len(texts), 'document')}\nCheck it: aos lint {folder}")


def _write(folder: Path, texts: dict[str, str]) -> None:
    """All files, into a directory that is new or empty."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            hint = "Nothing was written; name another directory with --out"
            raise DocumentError(f"{folder} is not empty", code="AOS111", hint=hint)
        for name, text in sorted(texts.items()):
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise DocumentError(f"{folder} cannot be written: {error.strerror}", code="AOS101") from error
