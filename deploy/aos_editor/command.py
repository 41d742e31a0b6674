"""`aos language-server`: what an editor starts to check documents while they are written."""

from aos_deploy.marked_commands import command


@command("Example: aos language-server", "language-server")
def serve() -> None:
    """Check documents while they are written.

    Speaks the Language Server Protocol over standard input and output.
    Editors start it by themselves; docs/editors.md in the sources of AOS has the settings.
    """
    from aos_editor.server import language_server  # The protocol's types take a while.

    language_server().start_io()
