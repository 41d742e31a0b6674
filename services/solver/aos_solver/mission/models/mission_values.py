"""The values of mission parameters in each model of a mission: those that it began with stay."""

from collections.abc import Mapping

from msgspec.structs import replace

from aos_language.findings import Findings
from aos_language.mission_parameters import ParameterLeaf, checked_values, usable_values
from aos_protocol.diagnostics import Span
from aos_protocol.documents import MissionValue

NOWHERE = Span("the documents")
"""The place of a value that nobody has set."""


class MissionValues:
    """The values that are `given` for a mission, and the `kept` ones, with which it began.

    The latter stay, whatever newer documents give by default.
    """

    def __init__(self, given: tuple[MissionValue, ...] = ()) -> None:
        self.given = given
        self.kept: Mapping[str, str] = {}

    def in_model(
        self, leaves: Mapping[str, ParameterLeaf], span: Span | None = None, *, is_first: bool
    ) -> dict[str, str]:
        """The mission's values for a model.

        DocumentError AOS146 where it cannot have one, at `span` or else where it was set. A parameter that
        nobody has set may be gone from newer documents. Before the first mission (`is_first`) more documents
        may come: the values that do not fit are told when it begins.
        """
        kept = (MissionValue(name, text, NOWHERE) for name, text in self.kept.items() if name in leaves)
        values = [replace(v, span=span or v.span) for v in (*kept, *self.given)]
        if is_first:
            return checked_values(values, leaves, Findings())
        return usable_values(values, leaves)
