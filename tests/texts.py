from collections.abc import Mapping
from pathlib import Path


def encoded(files: Mapping[str, str]) -> dict[str, bytes]:
    """The documents as they are read from a disk."""
    return {name: text.encode() for name, text in files.items()}


def write_texts(files: Mapping[str, str], folder: Path) -> None:
    """Writes the documents into a folder that is there."""
    for name, text in files.items():
        (folder / name).write_text(text)
