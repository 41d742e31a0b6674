"""A run as one MCAP file: rows of the journals, belief and values to plot, pictures. The only import of mcap.

/aos/<kind>        the rows of the journals of this kind: decision, mission, intended, outcome, steered, ...
/aos/plot/belief   at each decision record the marginals, the odds of the endings, entropy, surprise
/aos/plot/values   at each decision what each action is worth, with its standard error and visits
/aos/picture       the world's picture after each step, where the adapter has kept one
"""

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.writer import Writer

from aos_deploy.export.kept_missions import KeptMission, kept_missions
from aos_deploy.export.pictures import Picture, pictures_of
from aos_deploy.export.plain_schema import plain_schema, without_nulls
from aos_deploy.export.plotted import BELIEF, VALUES, belief_of, merged_schema, values_of
from aos_protocol import __version__
from aos_protocol.messages import DecisionRecord
from aos_protocol.mission_rows import MESSAGES
from aos_runtime.disk.journal import JournalRow

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
