"""Many missions of one setting, several at a time, none run twice where their records are kept."""

import asyncio
import hashlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

import msgspec
from msgspec.structs import replace

from aos_deploy.bundles.files import files_of_bundle
from aos_deploy.deployment.reading import Deployment
from aos_lab.trials.players import ModelMissions, ModelPlayer, ScriptPlayer, SystemPlayer
from aos_lab.trials.ray_cluster import RayPlayer
from aos_lab.trials.setting import Setting, deployment_of, world_deployment_of
from aos_lab.trials.trial import KeptTrial, Trial, kept_trials
from aos_protocol import __version__
from aos_protocol.documents import MissionValue
from aos_runtime.processes.lifecycle import root_cause

HERE = "local"
"""The name of this machine as the place where missions are played."""


class Place(msgspec.Struct, frozen=True, kw_only=True):
    """The machine, and how many missions it plays at a time.

    Missions of the model can be played `on` a Ray cluster, on `jobs` of its processors or on all; here it is
    one at a time if not said.
    """

    on: str = HERE
    jobs: int | None = None
    on_progress: Callable[[str], None] = lambda text: None


class Played(msgspec.Struct, frozen=True):
    """The trials in the order of their seeds, and the digest of what they were run with."""

    trials: tuple[Trial, ...]
    digest: str


class _Player(Protocol):
    async def play(self, seed: int) -> Trial: ...

    async def close(self) -> None: ...


async def play_campaign(
    setting: Setting,
    seeds: Sequence[int],
    *,
    folder: Path,
    out: Path,
    on_trial: Callable[[], None],
    place: Place | None = None,
    mission_values: tuple[MissionValue, ...] = (),
) -> Played:
    """Plays a mission of each seed. Records in `out` are used where they were made of the same.

    `mission_values` count before what the setting and the deploy file set.

    Missions that broke are run again. `folder` is where the setting's paths begin.
    """
    deployment = deployment_of(setting, folder, out)
    values = (*deployment.mission_values, *mission_values)
    deployment = replace(deployment, mission_values=values)
    world = world_deployment_of(setting, deployment, folder) if setting.by == "model" else None
    digest = _digest(setting, deployment, world)
    records = out / "missions.jsonl"
    kept = kept_trials(records) if records.is_file() else ()
    done = {each.trial.seed: each.trial for each in kept if each.digest == digest}
    remaining = [seed for seed in seeds if seed not in done]
    for seed in seeds:
        if seed in done:
            on_trial()

    def keep(trial: Trial) -> None:
        done[trial.seed] = trial
        with records.open("ab") as file:
            file.write(msgspec.json.encode(KeptTrial(digest, trial)) + b"\n")
        on_trial()

    player: _Player
    place = place or Place()
    jobs = place.jobs
    if remaining:
        await asyncio.to_thread(out.mkdir, parents=True, exist_ok=True)
        if place.on != HERE and setting.by == "model":
            missions = ModelMissions.of(deployment, world)
            player = cluster = await RayPlayer.prepared(missions, place.on, jobs, place.on_progress)
            jobs = cluster.jobs
        else:
            player = await _player(setting, deployment, world, out, place.on_progress)
        try:
            await _play_all(player, remaining, jobs or 1, keep)
        finally:
            await player.close()
    return Played(tuple(done[seed] for seed in seeds), digest)


async def _play_all(player: _Player, seeds: Sequence[int], jobs: int, keep: Callable[[Trial], None]) -> None:
    queue = iter(seeds)

    async def work() -> None:
        for seed in queue:
            keep(await player.play(seed))

    try:
        async with asyncio.TaskGroup() as tasks:
            for _ in range(min(jobs, len(seeds))):
                tasks.create_task(work())
    except BaseExceptionGroup as group:
        raise root_cause(group) from group


async def _player(
    setting: Setting,
    deployment: Deployment,
    world: Deployment | None,
    out: Path,
    on_progress: Callable[[str], None],
) -> _Player:
    if setting.script:
        return await ScriptPlayer.prepared(deployment, setting.script, out)
    if setting.by == "model":
        return await ModelPlayer.prepared(ModelMissions.of(deployment, world), on_progress)
    return SystemPlayer(deployment, out / "runs")


def _digest(setting: Setting, deployment: Deployment, world: Deployment | None) -> str:
    """Returns the digest of all that a mission's outcome depends on beside its seed."""
    whole = hashlib.sha256(f"{__version__} {setting.by}".encode())
    whole.update(" > ".join(setting.script).encode())
    whole.update(msgspec.json.encode((deployment.file.mission, deployment.file.solver, deployment.file.bind)))
    if setting.by != "model" and (setting.faults or deployment.file.skills):
        whole.update(msgspec.json.encode((setting.faults, deployment.file.skills)))
    if deployment.mission_values:
        whole.update(msgspec.json.encode([(value.name, value.text) for value in deployment.mission_values]))
    for bundle in (*deployment.bundles, *(world.bundles if world is not None else ())):
        for name, data in sorted(files_of_bundle(bundle, deployment.file.leave_out).items()):
            whole.update(f"{len(name)}:{name}:{len(data)}:".encode() + data)
    for path in (deployment.world if setting.by == "system" else None, deployment.policy):
        whole.update(path.read_bytes() if path is not None else b"-")
    return whole.hexdigest()[:16]
