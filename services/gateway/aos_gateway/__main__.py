"""`python -m aos_gateway` is `aos serve`."""

import typer

from aos_gateway.command import serve

if __name__ == "__main__":
    typer.run(serve)
