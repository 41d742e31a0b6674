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
from aos_deploy.options import HELP_NAMES, Version, add_commands
from aos_deploy.printing import print_fault
from aos_deploy.terminal import write_what_fits
from aos_deploy.told_numbers import NumbersToldGroup
from aos_protocol.errors import AosError

_COMMANDS = {
    "up": ("aos_deploy.commands.up", "Bring a robot's system up and run its mission."),
    "down": ("aos_deploy.commands.down", "End a running system in order."),
    "logs": ("aos_deploy.commands.logs", "Print the logs of a run."),
    "decisions": ("aos_deploy.commands.decisions", "Print every decision of a mission from its first step."),
    "export": ("aos_deploy.commands.export", "Write the records of runs to files to take home."),
    "serve": ("aos_gateway.command", "Show runs, living and past, on a page and over HTTP."),
    "check": ("aos_deploy.commands.check", "Check a run's journal and ledgers against each other."),
    "replay": ("aos_deploy.commands.replay", "Compute a mission once more, and compare each decision."),
    "diff": ("aos_deploy.commands.replay", "Compare two missions up to where they part."),
    "drift": ("aos_deploy.commands.drift", "Test whether skills do what their documents say."),
    "why": ("aos_deploy.commands.why", "Explain a decision."),
    "whatif": ("aos_deploy.commands.why", "Decide a step anew under other circumstances."),
    "resume": ("aos_deploy.commands.skill", "Go on with a mission that holds."),
    "lint": ("aos_deploy.commands.documents", "Check a bundle and print everything that is wrong."),
    "inspect": ("aos_deploy.commands.documents", "Print what becomes of a bundle."),
    "convert": ("aos_deploy.commands.convert", "Write a bundle's documents in SDL or in AOS 1.x JSON."),
    "schema": ("aos_deploy.commands.schema", "Print a JSON Schema for editors."),
    "language-server": ("aos_editor.command", "Check documents while they are written."),
    "plan": ("aos_deploy.commands.plan", "Decide at the initial belief."),
    "rate": ("aos_deploy.commands.plan", "Measure how many samples a second the model gives."),
    "simulate": ("aos_lab.commands.simulate", "Run whole missions against the documents' own model."),
    "solve": ("aos_lab.commands.solve", "Work out a policy before the mission."),
    "test": ("aos_lab.commands.test", "Run missions and check what is claimed of them."),
    "calibrate": ("aos_lab.commands.calibrate", "Estimate the documents' probabilities from missions."),
    "bench": ("aos_lab.commands.bench", "Measure sampling, search and returns."),
    "gym": ("aos_lab.commands.gym", "Describe a bundle as a Gymnasium environment."),
    "doctor": ("aos_deploy.commands.machine", "Say what this machine has and lacks."),
    "mission": ("aos_deploy.commands.mission", "Start, stop, list and steer missions."),
    "runs": ("aos_deploy.commands.runs", "List the missions of this machine."),
    "skill": ("aos_deploy.commands.skill", "See, call and stop the skills of a running system."),
    "bundle": ("aos_deploy.commands.bundle", "Send documents to a running system, or list them."),
    "new": ("aos_deploy.commands.new", "Write documents, an adapter or a whole example."),
    "experiment": ("aos_lab.commands.experiment", "Run an experiment, and see which of its claims hold."),
}
"""The module of each command and its sentence, in the order of the help, which imports none of them.
They are named here since laboratory, editor and gateway are above this package."""

_MEANT = {"status": "runs", "ps": "runs", "stop": "down", "kill": "down", "start": "up", "run": "up"}
"""The commands that whoever knows other tools may mean."""

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


class AosGroup(NumbersToldGroup):
    """The commands of `aos`; a name of other tools is answered with the command that does it here."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        if args[0] in _MEANT:
            ctx.fail(f"No such command {args[0]!r}. Did you mean {_MEANT[args[0]]!r}?")
        return super().resolve_command(ctx, args)


def aos_app(arguments: Sequence[str] | None = None) -> typer.Typer:
    """`aos` with all commands; of arguments with the one that they call, or with the names of all.

    The faults of commands come out of it.
    """
    app = typer.Typer(
        name="aos",
        cls=AosGroup,
        no_args_is_help=True,
        help="Task-level autonomy for robots: documents in, decisions out.",
        epilog="Example: aos new example armadillo, then aos-up armadillo/armadillo.yaml",
        context_settings=HELP_NAMES,
        **_STYLE,
    )
    app.callback()(_own_options)
    called = None if arguments is None else _called(arguments)
    if called == "":
        for name, (_, sentence) in _COMMANDS.items():
            app.command(name, help=sentence)(_only_named)
    else:
        for module in dict.fromkeys(_COMMANDS[name][0] for name in ([called] if called else _COMMANDS)):
            add_commands(app, import_module(module))
    return app


def up_main(has_imported: Callable[[], object] = lambda: None) -> NoReturn:
    """`aos-up`, as `main`."""
    _run(_up_app, "aos-up", has_imported)


def _up_app() -> typer.Typer:
    app = typer.Typer(**_STYLE)
    add_commands(app, import_module("aos_deploy.commands.up"))
    return app


def _called(arguments: Sequence[str]) -> str:
    """Returns the command that is called, whose imports alone are worth their time; "" if none is."""
    words = [word for word in arguments or _words_to_complete() if not word.startswith("-")]
    return words[0] if words and words[0] in _COMMANDS else ""


def _only_named() -> None:
    """Stands for a command in the help, in completion and among names that a wrong one may have meant."""


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
