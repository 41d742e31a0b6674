"""`aos serve`: the runs of this machine over HTTP, and the page that shows them."""

from ipaddress import ip_address
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from aos_deploy.export.run_bundle import opened_bundle
from aos_deploy.options import command, seconds
from aos_deploy.runs.living import runs_here
from aos_protocol.errors import DeployError

Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="The port; 0 takes any free one")]


class ServeOptions(NamedTuple):
    """The runs that are shown, where, and to whom."""

    files: Annotated[
        list[Path] | None,
        typer.Argument(metavar="FILE", help="Runs that somebody has sent, from aos export --format bundle"),
    ] = None
    listen: Annotated[
        str, typer.Option("--listen", metavar="ADDRESS", help="The address that it listens at")
    ] = "127.0.0.1"
    port: Port = 7480
    host: Annotated[
        list[str] | None, typer.Option("--host", metavar="NAME", help="Another name that it answers to")
    ] = None
    open_: Annotated[
        bool, typer.Option("--open", help="On loopback all users of the machine may read, without the token")
    ] = False
    runs: Annotated[
        list[Path] | None,
        typer.Option("--runs", metavar="DIR", help="A folder of runs, besides those that run anywhere"),
    ] = None
    projects: Annotated[
        list[Path] | None,
        typer.Option("--projects", metavar="DIR", help="A folder of deploy files that the page may start"),
    ] = None
    connect: Annotated[
        list[str] | None,
        typer.Option("--connect", metavar="ENDPOINT", help="A system elsewhere, with --robot"),
    ] = None
    robot: Annotated[
        list[str] | None, typer.Option("--robot", help="The robot at the endpoint, in the same order")
    ] = None
    metrics: Annotated[
        bool, typer.Option("--metrics", help="Also serve metrics for Prometheus, at /metrics")
    ] = False
    unused: Annotated[
        float | None,
        seconds("--unused", least=0, help="End after so many seconds without a mission or a look"),
    ] = None


@command("Example: aos serve, then open the address that it prints")
def serve(options: ServeOptions) -> None:
    """Show runs, living and past, on a page and over HTTP.

    It goes on after missions, and finds those that begin later. Ctrl-C ends it, and no mission with it.
    docs/http-api.md describes the API, docs/page.md the page.
    """
    import asyncio  # Here, so that --help needs none of it.

    try:
        from aos_gateway.server import Settings, serve_gateway
    except ModuleNotFoundError as error:
        raise DeployError(
            f"the page needs {error.name}", code="AOS805", hint="pip install 'aos-autonomy[page]'"
        ) from error

    endpoints, robots = options.connect or [], options.robot or []
    if len(endpoints) != len(robots):
        raise typer.BadParameter("give one --robot for each --connect", param_hint="--robot")
    for folder in (*(options.runs or ()), *(options.projects or ())):
        if not folder.is_dir():
            typer.echo(f"{folder} is no folder yet; it is shown once it is there", err=True)
    if options.listen != "localhost" and not _is_address(options.listen):
        raise typer.BadParameter("no address of this machine", param_hint="--listen")

    sent = [run for file in options.files or () for run in opened_bundle(file)]

    def ready(address: str, token: str) -> None:
        place = f"runs/{sent[0].name}" if len(sent) == 1 else ""
        typer.echo(f"{address}#/{place}?token={token}")
        typer.echo("Whoever has this address may start and stop missions. Ctrl-C ends the gateway.")

    settings = Settings(
        host="127.0.0.1" if options.listen == "localhost" else options.listen,
        port=options.port,
        names=tuple(options.host or ()),
        is_private=not options.open_,
        runs=tuple(options.runs or [runs_here()]),
        sent=tuple(sent),
        projects=tuple(options.projects or [Path()]),
        remote=tuple(zip(endpoints, robots, strict=True)),
        has_metrics=options.metrics,
        unused_s=options.unused,
    )
    try:
        asyncio.run(serve_gateway(settings, ready))
    except KeyboardInterrupt:
        raise typer.Exit(0) from None


def _is_address(text: str) -> bool:
    try:
        ip_address(text)
    except ValueError:
        return False
    return True
