"""The command line: puts the sub-commands together, and turns faults into one message and an exit code."""

import errno
import os
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NoReturn

import typer

from aos_deploy.exit_codes import ExitCode, exit_code_of_error
from aos_deploy.faults import print_fault
from aos_deploy.options import HELP_NAMES, Version
from aos_deploy.terminal import write_what_fits
from aos_protocol.errors import AosError

_COMMANDS = {
    "aos_deploy.commands.up": ("up",),
    "aos_deploy.commands.mission": ("mission",),
    "aos_deploy.commands.decisions": ("decisions",),
    "aos_deploy.commands.runs": ("runs",),
    "aos_deploy.commands.export": ("export",),
    "aos_gateway.command": ("serve",),
    "aos_deploy.commands.check": ("check",),
    "aos_deploy.commands.replay": ("replay", "diff"),
    "aos_deploy.commands.drift": ("drift",),
    "aos_deploy.commands.why": ("why", "whatif"),
    "aos_deploy.commands.skill": ("skill", "resume"),
    "aos_deploy.commands.documents": ("lint", "inspect"),
    "aos_deploy.commands.bundle": ("bundle",),
    "aos_deploy.commands.convert": ("convert",),
    "aos_deploy.commands.new": ("new",),
    "aos_deploy.commands.schema": ("schema",),
    "aos_editor.command": ("language-server",),
    "aos_deploy.commands.plan": ("plan", "rate"),
    "aos_lab.commands.simulate": ("simulate",),
    "aos_lab.commands.solve": ("solve",),
    "aos_lab.commands.test": ("test",),
    "aos_lab.commands.experiment": ("experiment",),
    "aos_lab.commands.calibrate": ("calibrate",),
    "aos_lab.commands.bench": ("bench",),
    "aos_lab.commands.gym": ("gym",),
    "aos_deploy.commands.machine": ("doctor",),
}
"""The modules, in the order of the help, with the names that each registers. They are named here and not
imported: laboratory, editor and gateway are above this package."""

_UNWRITABLE = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
_UNUSABLE = (errno.EACCES, errno.EPERM, errno.ENAMETOOLONG, errno.ENOTDIR, errno.ELOOP)

_STYLE: dict[str, Any] = {
    "pretty_exceptions_enable": False,
    # Rich would keep the line breaks of the docstrings, and takes a fifth of a second to import.
    "rich_markup_mode": None,
}


def main(has_imported: Callable[[], object] = lambda: None) -> NoReturn:
    """`aos`; `has_imported` is called before its command runs."""
    _run(lambda: aos_app(sys.argv[1:]), "aos", has_imported)


def aos_app(arguments: Sequence[str] = ()) -> typer.Typer:
    """`aos` with the command that the arguments name, or with all; the faults of commands come out of it."""
    app = typer.Typer(
        name="aos",
        no_args_is_help=True,
        help="Task-level autonomy for robots: documents in, decisions out.",
        epilog="Example: aos new example armadillo, then aos-up armadillo/armadillo.yaml",
        context_settings=HELP_NAMES,
        **_STYLE,
    )
    app.callback()(_own_options)
    for module in _needed_modules(arguments):
        import_module(module).register(app)
    return app


def up_main(has_imported: Callable[[], object] = lambda: None) -> NoReturn:
    """`aos-up`, as `main`."""
    _run(_up_app, "aos-up", has_imported)


def _up_app() -> typer.Typer:
    app = typer.Typer(**_STYLE)
    import_module("aos_deploy.commands.up").register(app)
    return app


def _needed_modules(arguments: Sequence[str]) -> list[str]:
    """Returns only the module of the command that is called, so that others' imports cost nothing."""
    words = arguments or _words_to_complete()
    called = [module for module, names in _COMMANDS.items() if words and words[0] in names]
    return called or list(_COMMANDS)


def _words_to_complete() -> list[str]:
    """Returns the words before the one that a shell wants completed; none if no shell asks."""
    line = os.environ.get("COMP_WORDS") or os.environ.get("_TYPER_COMPLETE_ARGS") or ""
    return line.split()[1:]


def _own_options(version: Version = False) -> None:
    """Makes typer keep the names of commands: without a callback it takes a lone command for the whole
    program."""


def _run(make_app: Callable[[], typer.Typer], name: str, has_imported: Callable[[], object]) -> NoReturn:
    """Runs the command and ends the process: an AosError as its diagnostics and one line on stderr."""
    write_what_fits(sys.stdout)
    app = make_app()
    has_imported()
    try:
        try:
            app(prog_name=name)
        finally:
            if sys.stdout is not None and not sys.stdout.closed:
                sys.stdout.flush()
    except AosError as error:
        _end(name, error)
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):
            _end_unread()
        raise
    except BrokenPipeError:
        _end_unread()
    except OSError as error:
        if error.errno in _UNUSABLE and error.filename is not None:
            sys.stderr.write(f"{name}: {error.filename} cannot be used: {error.strerror}\n")
            sys.exit(ExitCode.NOT_STARTED)
        if error.errno not in _UNWRITABLE:
            raise
        sys.stderr.write(f"{name}: {error.filename or 'the output'} cannot be written: {error.strerror}\n")
        sys.stderr.flush()
        os._exit(ExitCode.NOT_STARTED)  # Python would write the rest once more.
    sys.exit(0)


def _end_unread() -> NoReturn:
    """Ends as any program does whose reader has gone, such as `head`: by SIGPIPE, which Python ignores."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGPIPE)
    os._exit(128 + signal.SIGPIPE)


def _end(name: str, error: AosError) -> NoReturn:
    print_fault(name, error)
    sys.exit(exit_code_of_error(error))
