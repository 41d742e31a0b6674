import asyncio
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import pytest

from aos_protocol.errors import LostAnswerError, NobodyAnswersError
from aos_protocol.keys import Keys
from aos_protocol.messages import Catalogue, Message, ProjectQuery
from aos_runtime.bus.bus import Bus
from aos_runtime.bus.presence import ServerWatch
from aos_runtime.processes.parent import PARENT_VARIABLE
from aos_runtime.processes.settings import ServiceSettings


@contextmanager
def router(endpoint: str, folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    path = folder / "router.json"
    settings = ServiceSettings(robot="test", service="router", endpoint=endpoint, run_dir=str(folder))
    path.write_bytes(msgspec.json.encode(settings))
    command = [sys.executable, "-m", "aos_runtime.router", str(path)]
    with subprocess.Popen(command, env={**os.environ, PARENT_VARIABLE: str(os.getpid())}) as process:
        try:
            yield process
        finally:
            process.kill()


async def test_a_question_is_lost_with_its_router_also_where_nobody_tells_of_that(
    tmp_path, keys: Keys, unused_tcp_port: int, monkeypatch
):
    endpoint = f"tcp/127.0.0.1:{unused_tcp_port}"
    is_asked = asyncio.Event()

    async def never(_: ProjectQuery, __: str) -> Message:
        is_asked.set()
        await asyncio.Event().wait()
        return Catalogue(())

    # Zenoh may forward a question for a moment into a link that is gone, and then nobody tells of it.
    monkeypatch.setattr(ServerWatch, "_leave", lambda self: None)
    monkeypatch.setattr(ServerWatch, "is_served", True)
    monkeypatch.setattr("aos_runtime.bus.question.Question._settle", lambda self, result: None)
    with router(endpoint, tmp_path) as first:
        async with (
            await Bus.open(endpoint, sender="asking", connect_timeout_s=60) as asking,
            await Bus.open(endpoint, sender="serving", connect_timeout_s=60) as serving,
        ):
            await serving.answer(keys.project, ProjectQuery, never)
            question = asyncio.create_task(asking.ask(keys.project, ProjectQuery(), Catalogue, timeout_s=600))
            await is_asked.wait()
            name = asking.router
            first.kill()
            first.wait()
            with router(endpoint, tmp_path):
                with pytest.raises((LostAnswerError, NobodyAnswersError)):
                    await question
                assert await asking.has_lost_router(name)
