from collections.abc import Iterable
from typing import Any

from mapping_documents import emitted

from aos_middleware.emission.emit import EmittedMapping
from aos_middleware.workers.frames import Begin, Begun, Finish, Load, Observed, Raised, Take
from aos_middleware.workers.worker import LoadedMapping

HEAD = """\
project: garden
module_activation: skill
path: /look
"""

Messages = Iterable[tuple[str, dict[str, Any]]]


def emitted_with(text: str) -> EmittedMapping:
    """The generated module of a mapping that says this, too."""
    return emitted(HEAD + text)


def running(text: str) -> LoadedMapping:
    """The module of such a mapping, ready for activations."""
    return loaded(emitted_with(text))


def loaded(mapping: EmittedMapping, allowed_imports: tuple[str, ...] | None = None) -> LoadedMapping:
    """The module, ready for activations."""
    return LoadedMapping(Load(mapping.python, mapping.file_name, 60.0, 60.0, allowed_imports, mapping.truths))


def fields(mapping: LoadedMapping, parameters: dict[str, Any]) -> dict[str, Any]:
    answer = mapping.answer(Begin(parameters))
    assert isinstance(answer, Begun), answer
    return answer.fields


def raised(mapping: LoadedMapping, then: Take | Finish) -> Raised:
    fields(mapping, {})
    answer = mapping.answer(then)
    assert isinstance(answer, Raised), answer
    return answer


def observed(
    mapping: LoadedMapping, parameters: dict[str, Any], messages: Messages, result: dict[str, Any]
) -> Observed:
    """The outcome of a whole activation that raises nothing."""
    fields(mapping, parameters)
    fault = mapping.answer(Take(list(messages)))
    assert not isinstance(fault, Raised), fault
    answer = mapping.answer(Finish(result))
    assert isinstance(answer, Observed), answer
    return answer
