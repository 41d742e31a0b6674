"""`aos gym`: a bundle as an environment for learning programs."""

from __future__ import annotations

import importlib.util
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer

from aos_deploy.deployment.mission_values import SetValues, values_of_options
from aos_deploy.options import AsJson, TrustDocuments, command
from aos_deploy.printing import show
from aos_deploy.terminal import progress, waiting
from aos_protocol.errors import DeployError
from aos_runtime.distribution import pip_install

if TYPE_CHECKING:
    from aos_lab.gym import AosVectorEnv

_SNIPPET = """\
from aos_lab.gym import AosVectorEnv

worlds = AosVectorEnv({bundle!r}, num_envs=64, max_episode_steps=100{more})
observations, _ = worlds.reset(seed=1)
for _ in range(1000):
    actions = worlds.action_space.sample()
    observations, rewards, terminated, truncated, _ = worlds.step(actions)
worlds.close()
"""


class Spaces(msgspec.Struct):
    """The output of `aos gym --json`. `steps_per_second` is of all worlds together, None if not measured."""

    action_space: str
    actions: tuple[str, ...]
    observation_space: str
    responses: tuple[str, ...]
    discount: float
    worlds: int
    steps_per_second: float | None


@command("Example: aos gym deploy/bundles/bench/tiger --steps 1000000")
def gym(
    bundle: Annotated[
        Path,
        typer.Argument(
            metavar="BUNDLE", help="A directory of documents; or a deploy file, for its bundles and values"
        ),
    ],
    steps: Annotated[int, typer.Option(min=0, help="Measure with so many random steps")] = 0,
    worlds: Annotated[int, typer.Option(min=1, help="Worlds side by side")] = 1024,
    seed: Annotated[int, typer.Option(min=0, help="Of the worlds and the actions")] = 1,
    set_values: SetValues = None,
    as_json: AsJson = False,
    trust_documents: TrustDocuments = False,
) -> None:
    """Describe a bundle as a Gymnasium environment.

    Prints its spaces and a program to start from.
    """
    if importlib.util.find_spec("gymnasium") is None:
        raise DeployError("gymnasium is not installed", code="AOS805", hint=f"Run {pip_install('gym')}")
    from aos_lab.gym import AosVectorEnv

    given = values_of_options(set_values)
    with waiting("compiling and starting the worlds", first_s=2):
        environment = AosVectorEnv(bundle, worlds, mission_values=given)
    try:
        rate = _rate(environment, steps, seed) if steps else None
        spaces = Spaces(
            str(environment.single_action_space),
            environment.action_names,
            str(environment.single_observation_space),
            environment.response_names,
            environment.discount,
            worlds,
            rate,
        )
    finally:
        environment.close()
    show(spaces, as_json, lambda spaces: _print(spaces, bundle, {value.name: value.text for value in given}))


def _rate(environment: AosVectorEnv, steps: int, seed: int) -> float:
    """Steps of all worlds in a second, with actions drawn beforehand."""
    environment.reset(seed=seed)
    environment.action_space.seed(seed)
    actions = environment.action_space.sample()
    rounds = -(-steps // environment.num_envs)
    start_s = time.monotonic()
    with progress() as bar:
        for _ in bar.track(range(rounds), description="steps", update_period=0.2):
            environment.step(actions)
    return rounds * environment.num_envs / (time.monotonic() - start_s)


def _print(spaces: Spaces, bundle: Path, values: dict[str, str]) -> None:
    typer.echo(f"actions       {spaces.action_space}: {', '.join(spaces.actions)}")
    typer.echo(f"observations  {spaces.observation_space}: {', '.join(spaces.responses)}")
    typer.echo(f"discount      {spaces.discount:g}")
    if spaces.steps_per_second is not None:
        typer.echo(f"rate          {spaces.steps_per_second:,.0f} steps/s in {spaces.worlds:,} worlds")
    more = f", mission_values={values!r}" if values else ""
    typer.echo(f"\n{_SNIPPET.format(bundle=str(bundle), more=more)}", nl=False)
