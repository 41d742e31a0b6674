import asyncio

from places import BUNDLES
from processes import HANG_S

from aos_language.load import load_bundle
from aos_protocol.documents import Project
from aos_protocol.errors import DocumentError
from aos_protocol.keys import Keys
from aos_protocol.messages import ProjectQuery, ProjectRevision
from aos_runtime.bus.bus import Bus
from aos_runtime.parties import registry_watch
from aos_runtime.parties.registry_watch import RegistryWatch


class Registry:
    """A registry that answers some questions too late, and then with revision 3 or with a refusal."""

    def __init__(self, late: int, project: Project | None):
        self.late = late
        self.project = project
        self.questions = 0

    async def answer(self, _: ProjectQuery, __: str) -> ProjectRevision:
        self.questions += 1
        if self.questions <= self.late:
            await asyncio.Event().wait()
        if self.project is None:
            raise DocumentError("the catalogue holds no project test", code="AOS110")
        return ProjectRevision(3, "digest", self.project)


async def test_documents_come_although_the_first_answers_are_late(
    bus: Bus, other: Bus, keys: Keys, monkeypatch
):
    monkeypatch.setattr(registry_watch, "ASK_TIMEOUT_S", 0.1)
    registry = Registry(2, load_bundle(BUNDLES / "errand").project)
    await other.answer(keys.project, ProjectQuery, registry.answer)
    given: asyncio.Queue[ProjectRevision] = asyncio.Queue()
    following = asyncio.create_task(RegistryWatch(bus, keys, "errand", given.put).follow())
    revision = await asyncio.wait_for(given.get(), HANG_S)
    following.cancel()
    assert (revision.revision, revision.project.name) == (3, "errand")
    assert registry.questions >= 3


async def test_whoever_asks_once_goes_on_without_documents(bus: Bus, other: Bus, keys: Keys, monkeypatch):
    monkeypatch.setattr(registry_watch, "ASK_TIMEOUT_S", 0.1)
    given: asyncio.Queue[ProjectRevision] = asyncio.Queue()
    await other.answer(keys.project, ProjectQuery, Registry(1, None).answer)
    watch = RegistryWatch(bus, keys, "test", given.put)
    await watch.adopt_current()  # Its answer is late.
    await watch.adopt_current()  # It is refused.
    assert given.empty()
