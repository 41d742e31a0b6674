"""Draws that count by their mean: noise of a reward, such as the cost of a drive that takes its time.

The expectation of a sum is the sum of the expectations. So a draw of `SampleNormal` or `SampleUniform` may be
replaced by its mean where only expected rewards count, if it goes into the reward alone, and only by sums,
differences, and factors and divisors that are free of it. Such a step has no continuous draw, and can be
enumerated.

The reading is of the text. Where the text leaves a doubt, the draw stays as it is.
"""

from collections.abc import Iterator, Mapping

from aos_language.cpp.linear import adds_only_to, identifiers_of, linear_draws
from aos_language.document_code import snippets_of
from aos_protocol.documents import Assignment, Project, Snippet

_REWARD = "__reward"
_CONTINUOUS = (("SampleNormal",), ("SampleUniform",))


def averaged_draws(project: Project) -> Mapping[Snippet, frozenset[int]]:
    """The draws that count by their mean, by where their calls start."""
    environment = project.environment
    earning = [environment.extrinsic_changes, *(skill.model.dynamic_model for skill in project.skills)]
    others = [special.code for special in environment.special_states]
    # What the reward was must decide on nothing.
    if not all(adds_only_to(cpp, _REWARD) for code in (*earning, *others) for _, cpp in snippets_of(code)):
        return {}
    found: dict[Snippet, frozenset[int]] = {}
    for code in earning:
        for snippet, averaged in _of_section(code):
            # A snippet that belongs to two sections is emitted once.
            found[snippet] = found.get(snippet, averaged) & averaged
    return found


def _of_section(code: tuple[Assignment, ...]) -> Iterator[tuple[Snippet, frozenset[int]]]:
    snippets = list(snippets_of(code))
    for snippet, cpp in snippets:
        starts = sorted(call.function.start for call in cpp.calls if call.name[-1:] in _CONTINUOUS)
        others = (identifiers_of(other) for _, other in snippets if other is not cpp)
        draws = linear_draws(cpp, _REWARD, frozenset().union(*others))
        if len(starts) == len(draws):
            yield snippet, frozenset(at for at, is_linear in zip(starts, draws, strict=True) if is_linear)
