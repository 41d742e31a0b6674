"""`aos language-server`: what an editor starts to check documents while they are written."""

from typing import Annotated

import typer

from aos_deploy.options import command


@command("Example: aos language-server", "language-server")
def serve(
    grammar: Annotated[
        bool, typer.Option("--grammar", help="Print a TextMate grammar, for colours without the server")
    ] = False,
) -> None:
    """Check documents while they are written.

    Speaks the Language Server Protocol over standard input and output.
    Editors start it by themselves; docs/editors.md in the sources of AOS has the settings.
    """
    if grammar:
        from aos_editor.textmate_grammar import textmate_grammar

        typer.echo(textmate_grammar())
        return
    from aos_editor.server import language_server  # The protocol's types take a while.

    language_server().start_io()
