"""`aos language-server`: what an editor starts to check documents while they are written."""

import typer


def register(app: typer.Typer) -> None:
    """Adds the command to `aos`."""
    app.command("language-server", epilog="Example: aos language-server")(serve)


def serve() -> None:
    """Check documents while they are written.

    Speaks the Language Server Protocol over standard input and output.
    Editors start it by themselves; docs/editors.md in the sources of AOS has the settings.
    """
    from aos_editor.server import language_server  # The protocol's types take a while.

    language_server().start_io()
