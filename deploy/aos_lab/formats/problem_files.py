"""Problem files of other planners, by the ending of their names."""

from collections.abc import Callable
from pathlib import Path

from aos_lab.formats import problem_ending
from aos_lab.formats.factored_model import MAX_STATES, flatten
from aos_lab.formats.pomdp_reader import read_pomdp
from aos_lab.formats.pomdpx_reader import read_pomdpx
from aos_protocol.errors import DocumentError, IntractableError
from aos_solver.offline.explicit_model import ExplicitModel


def read_problem(
    path: Path, *, max_states: int = MAX_STATES, on_progress: Callable[[int], None] = lambda states: None
) -> ExplicitModel:
    """The model of a file; DocumentError with its mistakes, IntractableError if it is too large."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise DocumentError(f"cannot read {path}: {error.strerror}", code="AOS101") from error
    if problem_ending(path) == ".pomdpx":
        try:
            factored = read_pomdpx(str(path), data)
        except MemoryError:
            raise IntractableError(f"a table of {path} is too large once it is written out") from None
        return flatten(factored, max_states=max_states, on_progress=on_progress)
    model = read_pomdp(str(path), data)
    if model.size.states > max_states:
        raise IntractableError(f"{path} has {model.size.states} states, more than {max_states}")
    return model
