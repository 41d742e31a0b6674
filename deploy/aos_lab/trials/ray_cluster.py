"""Missions of the model on a Ray cluster: the only door to `ray`.

A worker gets the documents and what else a mission depends on, compiles the model once, and plays seeds.
Nothing else is needed there but AOS itself, in the same version, and a C++ compiler.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import msgspec

from aos_lab.trials.players import ModelMissions, ModelPlayer
from aos_lab.trials.trial import Trial
from aos_protocol.errors import AosError, DeployError
from aos_runtime.distribution import pip_install

OWN = "ray"
"""The word in place of an address: a Ray of our own on this machine, with a worker for each processor."""

_PACKAGES = ("aos_protocol", "aos_language", "aos_runtime", "aos_solver", "aos_deploy", "aos_lab")
"""The packages that play missions of the model."""

REACH_S = 30.0
"""The cluster has this time to answer, and a machine of it to say what it has."""
MISSION_S = 1800.0
"""A mission that takes longer, with the compilation before the first, ends the command."""


class RayPlayer:
    """Plays missions on a cluster's processors, one on each; `jobs` is how many there are."""

    def __init__(self, workers: list[Any]) -> None:
        self.jobs = len(workers)
        self._idle: asyncio.Queue[Any] = asyncio.Queue()
        for worker in workers:
            self._idle.put_nowait(worker)

    @classmethod
    async def prepared(
        cls, missions: ModelMissions, address: str, jobs: int | None, on_progress: Callable[[str], None]
    ) -> RayPlayer:
        """A player on the cluster at this address, on `jobs` of its processors, by default on all.

        DeployError AOS805 where Ray is not installed here, AOS809 where the cluster cannot be used, and why.
        """
        ray = _ray()
        await asyncio.to_thread(_connect, ray, address)
        try:
            await _check_machines(ray)
            processors = int(ray.cluster_resources().get("CPU", 0))
            count = min(jobs or processors, processors)
            if count == 0:
                raise _unusable("the cluster has no processor", "Add a machine with ray start")
        except BaseException:
            await asyncio.to_thread(ray.shutdown)
            raise
        on_progress(f"{count} of {processors} processors of the Ray cluster {address}")
        remote = ray.remote(num_cpus=1)(_Worker)
        return cls([remote.remote(missions) for _ in range(count)])

    async def close(self) -> None:
        """Leaves the cluster, which ends the workers."""
        await asyncio.to_thread(_ray().shutdown)

    async def play(self, seed: int) -> Trial:
        """One mission, on whichever processor is free; DeployError AOS809 if its worker is lost."""
        worker = await self._idle.get()
        try:
            data = await _answer(worker.play.remote(seed), MISSION_S, f"the mission of seed {seed}")
        finally:
            self._idle.put_nowait(worker)
        return msgspec.json.decode(data, type=Trial)


class _Worker:
    """The player on a machine of the cluster, made with the first mission.

    It has no coroutine of its own, which would make Ray run a loop around it.
    """

    def __init__(self, missions: ModelMissions) -> None:
        self._missions = missions
        self._player: ModelPlayer | None = None

    def play(self, seed: int) -> bytes:
        if self._player is None:
            self._player = asyncio.run(ModelPlayer.prepared(self._missions))
        return msgspec.json.encode(asyncio.run(self._player.play(seed)))


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        message = "missions on a cluster need the package ray, which is not installed here"
        hint = f"Run {pip_install('ray')}, or leave --on out"
        raise DeployError(message, code="AOS805", hint=hint) from None
    return ray


def _connect(ray: Any, address: str) -> None:
    quiet = {"logging_level": "ERROR", "log_to_driver": False}
    try:
        if address == OWN:
            ray.init(include_dashboard=False, **quiet)
            return
        try:
            ray.init(address, **quiet)
        except ConnectionAbortedError:
            # The head starts a process for each client, and now and then one of them does not come up.
            ray.init(address, **quiet)
    except RuntimeError as error:
        # Ray compares its own version and Python's, and tells both.
        raise _unusable(
            _first_line(error), "Install the same versions of Ray and Python here and there"
        ) from error
    except (ConnectionError, TimeoutError, ValueError, OSError) as error:
        hint = (
            "Is its head running, is this the port of its client server (10001 by default), "
            "and is RAY_AUTH_TOKEN that of the cluster, where it has one?"
        )
        raise _unusable(f"{address} cannot be reached: {_first_line(error)}", hint) from error


async def _check_machines(ray: Any) -> None:
    """Every machine has AOS with the same sources; DeployError AOS809 names the first that has not."""
    from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

    ours = _sources_of(_PACKAGES)
    for node in ray.nodes():
        if not node["Alive"] or not node["Resources"].get("CPU"):
            continue
        there = NodeAffinitySchedulingStrategy(node_id=node["NodeID"], soft=False)
        # By value: a machine without AOS could not even be asked by name.
        asked = ray.remote(num_cpus=0, scheduling_strategy=there)(_by_value(_ask_sources)).remote(_PACKAGES)
        theirs = await _answer(asked, REACH_S, f"the machine {node['NodeManagerAddress']}")
        if theirs == ours:
            continue
        name = node["NodeManagerAddress"]
        if not theirs[0]:
            raise _unusable(
                f"{name} has no AOS", "Install the same AOS into the Python that Ray runs in there"
            )
        there_text, here_text = (f"{version} with sources {digest[:8]}" for version, digest in (theirs, ours))
        raise _unusable(
            f"{name} has another AOS: {there_text} there, {here_text} here",
            "Install the same AOS there; results of another one would not be the same",
        )


def _sources_of(names: tuple[str, ...]) -> tuple[str, str]:
    """The version of AOS and a digest of these packages' sources; two empty texts where there is none.

    It runs on machines that may have none, and so uses nothing of this module.
    """
    import hashlib
    from importlib.metadata import version
    from importlib.util import find_spec
    from pathlib import Path

    whole = hashlib.sha256()
    for name in names:
        spec = find_spec(name)
        if spec is None or not spec.submodule_search_locations:
            return "", ""
        folder = Path(spec.submodule_search_locations[0])
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".py", ".hpp", ".cpp", ".jinja") and path.is_file():
                whole.update(f"{path.relative_to(folder)}".encode() + path.read_bytes())
    return version("aos-autonomy"), whole.hexdigest()


_ask_sources = _sources_of
"""The function as it is sent, whatever stands in its place here."""


def _by_value(function: Any) -> Any:
    """The function as one that Ray sends with its code instead of its name."""
    import types

    return types.FunctionType(
        function.__code__, {"__builtins__": __builtins__, "__name__": "__main__"}, "sources"
    )


async def _answer(reference: Any, timeout_s: float, what: str) -> Any:
    """Returns what a remote call gives; raises its AosError, or DeployError AOS809 where there is no
    answer."""
    try:
        return await asyncio.wait_for(asyncio.wrap_future(reference.future()), timeout_s)
    except TimeoutError:
        raise _unusable(
            f"{what} brought no answer within {timeout_s:g} s", "Look at the cluster's load"
        ) from None
    except Exception as error:
        # Ray's errors are of the class of their cause as well, with a traceback as their text.
        cause = getattr(error, "cause", None)
        if isinstance(cause, AosError):
            raise cause from None
        raise _unusable(
            f"{what} was lost: {_first_line(cause or error)}", "Run the command again: it goes on"
        ) from error


def _first_line(error: BaseException) -> str:
    """Returns the first line of an error, with the next line where the first one only announces it."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    if not lines:
        return type(error).__name__
    return " ".join(lines[:2]) if lines[0].endswith(":") else lines[0]


def _unusable(message: str, hint: str) -> DeployError:
    return DeployError(message, code="AOS809", hint=hint)
