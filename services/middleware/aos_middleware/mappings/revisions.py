"""The mappings of a project's revisions: generated, loaded, and exchanged between activations.

The newest four revisions are kept, and that of the newest activation: the solver may still decide with the
model before the newest ones, whose responses are those of that revision's mappings. A mapping that did not
change is shared between them.
"""

import asyncio
import contextlib
import logging
from collections.abc import Callable
from pathlib import Path

from aos_middleware.emission.emit import EmittedMapping, emit_mapping, emit_monitor
from aos_middleware.mappings.low_level import default_constants
from aos_middleware.workers.evaluator import Evaluator
from aos_protocol.diagnostics import Diagnostic
from aos_protocol.documents import Project
from aos_protocol.errors import AosError, DocumentError, SkillError
from aos_protocol.messages import MappingState, ProjectRevision
from aos_protocol.spelling import did_you_mean

_KEPT = 4

_log = logging.getLogger("aos.middleware")


def emit_project(project: Project) -> tuple[EmittedMapping, ...]:
    """The mappings of all skills and monitors; DocumentError AOS121 with every diagnostic if one cannot be
    generated."""
    emitted: list[EmittedMapping] = []
    diagnostics: list[Diagnostic] = []
    constants = default_constants(project)
    for skill in project.skills:
        try:
            shared = project.environment.shared_mapping_code
            emitted.append(emit_mapping(skill, project.low_level, constants, shared))
        except DocumentError as error:
            diagnostics += error.diagnostics
    for monitor in project.monitors:
        try:
            emitted.append(emit_monitor(monitor, project.low_level, project.environment.shared_mapping_code))
        except DocumentError as error:
            diagnostics += error.diagnostics
    if diagnostics:
        message = f"abstraction mappings of {project.name} cannot be used"
        hint = "Mend the places named with this error"
        raise DocumentError(message, code="AOS121", hint=hint, diagnostics=tuple(diagnostics))
    return tuple(emitted)


class Mappings:
    """Evaluators by revision and skill. A revision that cannot be used is refused and changes nothing."""

    def __init__(
        self,
        folder: Path,
        make_evaluator: Callable[[EmittedMapping], Evaluator],
        on_change: Callable[[], None],
    ) -> None:
        """`folder` receives the modules of the newest revision, for people; `on_change` is called after each
        change."""
        self._folder = folder
        self._make_evaluator = make_evaluator
        self._on_change = on_change
        self._kept: dict[int, dict[str, Evaluator]] = {}
        self._refusal: AosError | None = None
        self._refused = 0
        self._announced = 0
        self._in_use = 0
        self._adopting = asyncio.Lock()
        self._has_first = asyncio.Event()

    @property
    def state(self) -> MappingState:
        """The newest revision with its skills, sorted, the newest that was refused, and those that are
        kept."""
        return MappingState(
            self._revision,
            tuple(sorted(_skills(self._newest))),
            self._refused,
            revisions=tuple(sorted(self._kept)),
        )

    @property
    def monitors(self) -> dict[str, Evaluator]:
        """The monitors of the newest revision in use, by name."""
        return {name: found for name, found in self._newest.items() if found.emitted.mapping.monitor}

    @property
    def paths(self) -> dict[str, str]:
        """The activation path of each skill of the newest revision in use."""
        return {
            skill: evaluator.emitted.mapping.activation.path
            for skill, evaluator in _skills(self._newest).items()
        }

    def evaluator(self, skill: str, revision: int = 0) -> Evaluator:
        """The evaluator of a skill in a revision, or in the newest where that one is not kept.

        SkillError AOS501 if there is no such skill; the reason of the refusal if no revision could be used.
        """
        self._in_use = max(self._in_use, revision)
        mappings = _skills(self._kept.get(revision) or self._newest)
        if skill in mappings:
            return mappings[skill]
        if not self._kept and self._refusal is not None:
            raise self._refusal
        known = did_you_mean(skill, mappings) or f"Known are: {', '.join(sorted(mappings)) or 'none'}"
        raise SkillError(f"there is no skill {skill}", code="AOS501", hint=known)

    async def adopt(self, announced: ProjectRevision) -> None:
        """Generates a revision's mappings and puts them to use; older ones, and repeats, are passed over.

        What replaces mappings in use is loaded first, so that a mapping that cannot be loaded replaces
        nothing.
        """
        self._announced = max(self._announced, announced.revision)
        async with self._adopting:
            if announced.revision < self._announced or announced.revision in self._kept:
                return
            try:
                await self._adopt(announced)
            except AosError as error:
                self._refuse(announced.revision, error)

    async def until_first(self, timeout_s: float) -> None:
        """Returns once a revision is in use or refused, or in time."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                await self._has_first.wait()

    async def close(self) -> None:
        """Ends all workers."""
        for evaluator in self._evaluators():
            await evaluator.close()
        self._kept.clear()

    @property
    def _revision(self) -> int:
        return max(self._kept, default=0)

    @property
    def _newest(self) -> dict[str, Evaluator]:
        return self._kept.get(self._revision, {})

    async def _adopt(self, announced: ProjectRevision) -> None:
        emitted = emit_project(announced.project)
        mappings = {mapping.skill: self._same_or_new(mapping) for mapping in emitted}
        outdated = self._evaluators()
        if outdated:
            await _load(set(mappings.values()) - outdated)
        self._kept[announced.revision] = mappings
        newest = sorted(self._kept)[-_KEPT:]
        self._kept = {
            revision: each for revision, each in self._kept.items() if revision in (*newest, self._in_use)
        }
        self._write(emitted)
        _log.info("revision %d: mappings of %s", announced.revision, ", ".join(sorted(mappings)))
        self._has_first.set()
        self._on_change()
        for evaluator in outdated - self._evaluators():
            async with evaluator.in_use:
                await evaluator.close()

    def _refuse(self, revision: int, error: AosError) -> None:
        self._refusal, self._refused = error, revision
        _log.error("revision %d is not used: %s", revision, error)
        for diagnostic in error.diagnostics:
            _log.error("%s: %s", diagnostic.span, diagnostic.message)
        self._has_first.set()
        self._on_change()

    def _same_or_new(self, emitted: EmittedMapping) -> Evaluator:
        current = self._newest.get(emitted.skill)
        if current is not None and current.emitted.digest == emitted.digest:
            return current
        return self._make_evaluator(emitted)

    def _evaluators(self) -> set[Evaluator]:
        return {evaluator for mappings in self._kept.values() for evaluator in mappings.values()}

    def _write(self, emitted: tuple[EmittedMapping, ...]) -> None:
        """Puts the modules where people can read them; nothing depends on it."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            for path in self._folder.glob("*.py"):
                if path.name not in {mapping.file_name for mapping in emitted}:
                    path.unlink()
            for mapping in emitted:
                (self._folder / mapping.file_name).write_text(mapping.python, encoding="utf-8")
        except OSError as error:
            _log.warning("the generated modules are not in %s: %s", self._folder, error)


def _skills(mappings: dict[str, Evaluator]) -> dict[str, Evaluator]:
    return {name: evaluator for name, evaluator in mappings.items() if not evaluator.emitted.mapping.monitor}


async def _load(evaluators: set[Evaluator]) -> None:
    """Loads all of them, one after the other: the mission goes on meanwhile. None is left if one fails."""
    try:
        for evaluator in evaluators:
            await evaluator.start()
    except BaseException:
        for evaluator in evaluators:
            await evaluator.close()
        raise
