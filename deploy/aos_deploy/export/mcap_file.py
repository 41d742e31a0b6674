"""A run as one MCAP file: rows of the journals, belief and values to plot, pictures. The only import of mcap.

/aos/<kind>        the rows of the journals of this kind: decision, mission, intended, outcome, steered, ...
/aos/plot/belief   at each decision record the marginals, the odds of the endings, entropy, surprise
/aos/plot/values   at each decision what each action is worth, with its standard error and visits
/aos/picture       the world's picture after each step, where the adapter has kept one
"""

import base64
import json
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
from mcap.writer import Writer

from aos_deploy.export.kept_missions import KeptMission, kept_missions
from aos_deploy.export.plotted import BELIEF, VALUES, belief_of, merged_schema, values_of
from aos_protocol import __version__
from aos_protocol.messages import DecisionRecord
from aos_protocol.mission_rows import MESSAGES
from aos_runtime.disk.journal import JournalRow

_NAME = re.compile(r"step-(\d+)\.png")


class Picture(NamedTuple):
    """A picture after a step."""

    path: Path
    step: int
    stamp_ns: int


def pictures_of(run: Path, missions: Iterable[KeptMission]) -> list[Picture]:
    """The pictures of a run in the order of their times.

    Its time is that of the outcome of its step. In a system that stays a picture is of the mission that had
    this step when it was written: a later mission has written over those of earlier ones.
    """
    ends: dict[int, list[int]] = {}
    for mission in missions:
        for record in mission.decisions():
            if record.outcome is not None:
                ends.setdefault(record.step, []).append(record.outcome.ended_ns or record.stamp_ns)
    found = []
    for path in (run / "pictures").glob("step-*.png"):
        if name := _NAME.fullmatch(path.name):
            step, written_ns = int(name[1]), path.stat().st_mtime_ns
            stamp_ns = min(ends.get(step, [written_ns]), key=lambda end_ns: abs(end_ns - written_ns))
            found.append(Picture(path, step, stamp_ns))
    return sorted(found, key=lambda picture: (picture.stamp_ns, picture.step))


PICTURE = "/aos/picture"

_PICTURE_SCHEMA = {
    "title": "foxglove.CompressedImage",
    "type": "object",
    "properties": {
        "timestamp": {
            "type": "object",
            "title": "time",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
        },
        "frame_id": {"type": "string"},
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": {"type": "string"},
    },
    "required": ["timestamp", "frame_id", "data", "format"],
}
_ATTACHED_BYTES = 4_000_000
"""A log is attached as long as it is no longer than that."""


def write_mcap(run: Path, target: Path) -> int:
    """Writes the run to a file, and returns the number of its messages.

    StorageError AOS702 at a row of a journal that is damaged.
    """
    missions = kept_missions(run)
    with target.open("wb") as stream:
        file = _File(Writer(stream), missions)
        for mission in missions:
            for row in mission.rows():
                file.add_row(row)
        for picture in pictures_of(run, missions):
            file.add_picture(picture)
        for attached in _attached(run):
            file.attach(attached, run)
        file.finish(run)
    return file.messages


class _File:
    """A file that is written. Channels begin with their first message."""

    def __init__(self, writer: Writer, missions: list[KeptMission]) -> None:
        self.messages = 0
        self._writer = writer
        self._channels: dict[str, int] = {}
        self._missions = missions
        writer.start(library=f"aos {__version__}")

    def add_row(self, row: JournalRow) -> None:
        """A row of a journal, and what is plotted of it."""
        kind = MESSAGES.get(row.kind)
        schema = {"type": "object"} if kind is None else plain_schema(kind)
        name = "aos.Row" if kind is None else f"aos.{kind.__name__}"
        content = without_nulls(row.read_as(dict[str, Any]))
        self._add(f"/aos/{row.kind}", name, schema, content, row.stamp_ns, row.seq)
        if kind is not DecisionRecord:
            return
        record = row.read_as(DecisionRecord)
        self._plot(BELIEF, belief_of(record), row)
        if record.outcome is None:
            self._plot(VALUES, values_of(record), row)

    def add_picture(self, picture: Picture) -> None:
        seconds, nanoseconds = divmod(picture.stamp_ns, 1_000_000_000)
        content = {
            "timestamp": {"sec": seconds, "nsec": nanoseconds},
            "frame_id": "world",
            "data": base64.b64encode(picture.path.read_bytes()).decode(),
            "format": "png",
        }
        self._add(
            PICTURE, "foxglove.CompressedImage", _PICTURE_SCHEMA, content, picture.stamp_ns, picture.step
        )

    def attach(self, path: Path, run: Path) -> None:
        kind = "application/json" if path.suffix == ".json" else "text/plain"
        stamp_ns = path.stat().st_mtime_ns
        self._writer.add_attachment(stamp_ns, stamp_ns, str(path.relative_to(run)), kind, path.read_bytes())

    def finish(self, run: Path) -> None:
        """Writes the index."""
        names = {mission.name for mission in self._missions}
        self._writer.add_metadata(
            "aos", {"version": __version__, "run": run.resolve().name, "missions": " ".join(sorted(names))}
        )
        self._writer.finish()

    def _plot(self, topic: str, content: dict[str, Any], row: JournalRow) -> None:
        if topic not in self._channels:
            make = belief_of if topic == BELIEF else values_of
            whole = merged_schema(
                make(record)
                for mission in self._missions
                for record in mission.decisions()
                if topic == BELIEF or record.outcome is None
            )
            self._open(topic, f"aos.{topic.rpartition('/')[2].title()}", whole)
        self._add(topic, "", {}, content, row.stamp_ns, row.seq)

    def _add(
        self, topic: str, name: str, schema: dict[str, Any], content: Any, stamp_ns: int, sequence: int
    ) -> None:
        if topic not in self._channels:
            self._open(topic, name, schema)
        data = json.dumps(content, allow_nan=False).encode()
        self._writer.add_message(self._channels[topic], stamp_ns, data, stamp_ns, sequence)
        self.messages += 1

    def _open(self, topic: str, name: str, schema: dict[str, Any]) -> None:
        number = self._writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
        self._channels[topic] = self._writer.register_channel(topic, "json", number)


def _attached(run: Path) -> Iterator[Path]:
    for path in (run / "run.json", run / "summary.json", *sorted((run / "logs").glob("*.log"))):
        if path.is_file() and path.stat().st_size <= _ATTACHED_BYTES:
            yield path


def plain_schema(kind: type[Any]) -> dict[str, Any]:
    """The schema of a message, without references and without alternatives.

    What may be null is not required: `without_nulls` leaves it out. What may be of several types has none.
    """
    whole = msgspec.json.schema(kind)
    definitions = whole.get("$defs", {})
    return {"title": kind.__name__, **_plain(whole, definitions)}


def without_nulls(value: Any) -> Any:
    """JSON data whose objects lack the fields that are null."""
    if isinstance(value, dict):
        return {key: without_nulls(item) for key, item in value.items() if item is not None}
    if isinstance(value, list):
        return [without_nulls(item) for item in value]
    return value


def _plain(schema: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in schema:
        return _plain(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    if "anyOf" in schema:
        options = [option for option in schema["anyOf"] if option.get("type") != "null"]
        return _plain(options[0], definitions) if len(options) == 1 else {}
    kind = schema.get("type")
    if isinstance(kind, list):
        kinds = [each for each in kind if each != "null"]
        return {"type": kinds[0]} if len(kinds) == 1 else {}
    if kind == "object" and "properties" in schema:
        required = [
            name for name in schema.get("required", ()) if not _may_be_null(schema["properties"][name])
        ]
        properties = {name: _plain(each, definitions) for name, each in schema["properties"].items()}
        return {"type": "object", "properties": properties, **({"required": required} if required else {})}
    if kind == "array" and isinstance(schema.get("items"), dict):
        return {"type": "array", "items": _plain(schema["items"], definitions)}
    if "enum" in schema:
        return {"type": "string"}
    return {"type": kind} if kind else {}


def _may_be_null(schema: dict[str, Any]) -> bool:
    return schema.get("type") == "null" or any(_may_be_null(option) for option in schema.get("anyOf", ()))
