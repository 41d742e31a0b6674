"""The watched folder: bundles that were dropped into it, and those of them that wait for what they lack."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from pathlib import Path

from msgspec.structs import replace
from watchfiles import awatch

from aos_language.archive import is_archive_name
from aos_language.load import read_bundle_files
from aos_language.reading.files import is_document_name
from aos_protocol.diagnostics import Diagnostic, Severity, Span, has_errors
from aos_protocol.errors import AosError, StorageError
from aos_protocol.messages import BundleReport

LACKING = ("AOS105", "AOS110", "AOS113", "AOS114", "AOS115")
"""Other documents can mend these errors: something is missing, or a name that nothing defines."""

_log = logging.getLogger("aos.registry")

Take = Callable[[Mapping[str, bytes], str], Awaitable[BundleReport]]
IsStored = Callable[[str, bytes], bool]
"""Says whether any revision has held a file of this name and content."""


class DroppedBundles:
    """Takes what is dropped into a folder, by `take`. `tell` hears what became of each bundle.

    A bundle that is refused because it lacks something waits, and is taken once more, as it then stands in
    the folder, after each `project_changed`. Only a new answer is told, and none of a bundle that was there
    before and waits for the first project. An acceptance ends the waiting and a refusal changes no project,
    so that the bundles that wait cannot keep one another going.

    A document is taken once, until its file is written anew: a later push or removal stands, also where
    another document is put beside it, or the registry starts again.
    """

    def __init__(
        self,
        folder: Path,
        quiet_s: float,
        take: Take,
        tell: Callable[[BundleReport], None],
        is_stored: IsStored,
    ) -> None:
        self._folder = folder
        self._quiet_s = quiet_s
        self._take = take
        self._tell = tell
        self._is_stored = is_stored
        self._changed: asyncio.Queue[Path] = asyncio.Queue()
        self._waiting: dict[Path, BundleReport | None] = {}  # By what was told of them.
        self._again: set[Path] = set()
        self._from_before = {*bundles_in(folder)}
        self._not_looked_at = {*self._from_before}
        self._taken: dict[str, int] = {}  # When each document in the folder itself had been written.

    async def follow(self) -> None:
        """Follows the folder until it is cancelled."""
        await watch_for_bundles(self._folder, self._take_path, self._changed, quiet_s=self._quiet_s)

    def project_changed(self) -> None:
        """There is a new revision of a project: what waits is tried with it."""
        self._from_before.clear()
        self._waiting = {path: report for path, report in self._waiting.items() if path.exists()}
        for path in self._waiting:
            self._again.add(path)
            self._changed.put_nowait(path)

    async def _take_path(self, path: Path) -> None:
        was_waiting = self._waiting.pop(path, None)
        is_again = path in self._again
        self._again.discard(path)
        report = await self._report(path)
        if report is None:
            return
        if not report.is_accepted and {
            diagnostic.code for diagnostic in report.diagnostics if diagnostic.is_error
        } & {*LACKING}:
            report = replace(report, is_waiting=True)
            if path in self._from_before:
                self._waiting[path] = None
                return
            self._waiting[path] = report
        if not (is_again and was_waiting is not None and _says_the_same(report, was_waiting)):
            self._tell(report)

    async def _report(self, path: Path) -> BundleReport | None:
        """Takes a folder or an archive in and returns what becomes of it; None where it holds nothing new."""
        try:
            written = _written_ns(path) if path == self._folder else {}
            files, remarks = read_bundle_files(path)
            if path == self._folder:  # Other bundles stand beside its documents.
                remarks = [remark for remark in remarks if is_document_name(remark.span.file)]
            if has_errors(remarks):
                return BundleReport("", False, 0, tuple(remarks), source=path.name)
            if not files and path != self._folder and (remarks or is_archive_name(path.name)):
                hint = "They end in .ef, .sd, .am, .lf or .json, and lie side by side"
                return _refused(path, "AOS120", "there are no documents in it", hint)
            files = self._not_taken(path, files, written)
            report = await self._take(files, path.name) if files else None
            if report is not None and report.is_accepted:
                self._taken |= {name: written[name] for name in files if name in written}
            return report
        except AosError as error:
            return _refused(path, error.code, error.message, error.hint)
        except Exception as error:  # No bundle may take the registry down, whatever reading it runs into.
            _log.exception("the dropped bundle %s could not be taken", path.name)
            return _refused(path, "AOS606", f"it could not be taken: {error!r}", "See the registry's log")

    def _not_taken(
        self, path: Path, files: Mapping[str, bytes], written: Mapping[str, int]
    ) -> dict[str, bytes]:
        """Leaves out the documents that were taken before, by this registry or by one before it.

        A sub-folder or an archive in which something is new is taken whole.
        """
        if path in self._not_looked_at:
            self._not_looked_at.discard(path)
            stored = {name for name, content in files.items() if self._is_stored(name, content)}
            self._taken |= {name: written[name] for name in stored if name in written}
        else:
            stored = {name for name in files if name in written and written[name] == self._taken.get(name)}
        if path != self._folder and len(stored) < len(files):
            return {**files}
        return {name: content for name, content in files.items() if name not in stored}


def _written_ns(folder: Path) -> dict[str, int]:
    """Returns when each document in a folder was last written, renamed or touched."""
    written = {}
    for path in folder.iterdir():
        if is_document_name(path.name):
            with suppress(OSError):  # An editor has just renamed it, or it is a link to nothing.
                written[path.name] = path.stat().st_ctime_ns
    return written


def _refused(path: Path, code: str, message: str, hint: str) -> BundleReport:
    diagnostic = Diagnostic(Severity.ERROR, code, message, Span(path.name), hint)
    return BundleReport("", False, 0, (diagnostic,), source=path.name)


def _says_the_same(report: BundleReport, before: BundleReport) -> bool:
    return not report.is_accepted and report.diagnostics == before.diagnostics


_LONGEST_WAIT_S = 30.0

logging.getLogger("watchfiles").setLevel(logging.WARNING)


async def watch_for_bundles(
    folder: Path, take: Callable[[Path], Awaitable[None]], changed: asyncio.Queue[Path], *, quiet_s: float
) -> None:
    """Calls `take` with each sub-folder and archive in `folder`, one at a time, for ever.

    Documents that lie in `folder` itself are one bundle, for which `take` gets `folder`.

    First come those that are there, then each that has changed, and what else is put into `changed`. A bundle
    is taken once nothing changed for `quiet_s`, so that it is not read while it is being copied, and again
    after later changes. StorageError AOS701 for a folder that cannot be looked into.
    """
    async with asyncio.TaskGroup() as tasks:
        tasks.create_task(_follow(folder, changed, quiet_s))
        await asyncio.sleep(0)  # `_follow` has run to its first wait: the watch stands before the look.
        for path in bundles_in(folder):
            await take(path)
        while True:
            await take(await changed.get())


async def _follow(folder: Path, changed: asyncio.Queue[Path], quiet_s: float) -> None:
    step, debounce = int(quiet_s * 1000), int(_LONGEST_WAIT_S * 1000)
    try:
        async for batch in awatch(folder, step=step, debounce=debounce):
            touched = {_bundle_of(folder, Path(path)) for _, path in batch}
            for path in sorted(path for path in touched if path is not None and _is_bundle(path)):
                changed.put_nowait(path)
    except OSError as error:
        raise _unwatched(folder, error) from error


def bundles_in(folder: Path) -> list[Path]:
    """Returns what `take` is called with for a folder as it stands; StorageError AOS701 as above."""
    try:
        touched = {_bundle_of(folder, path) for path in folder.iterdir()}
    except OSError as error:
        raise _unwatched(folder, error) from error
    return sorted(path for path in touched if path is not None and _is_bundle(path))


def _unwatched(folder: Path, error: OSError) -> StorageError:
    text = f"the folder {folder} cannot be watched: {error.strerror or error}"
    return StorageError(text, hint="Name another one by `watch:`")


def _is_bundle(path: Path) -> bool:
    return path.is_dir() or (path.is_file() and is_archive_name(path.name))


def _bundle_of(folder: Path, path: Path) -> Path | None:
    """Returns what `take` is called with for a path that is there or has gone; None for hidden things."""
    parts = path.relative_to(folder).parts
    if not parts or any(part.startswith(".") for part in parts):
        return None
    is_document = len(parts) == 1 and is_document_name(parts[0]) and not path.is_dir()
    return folder if is_document else folder / parts[0]
