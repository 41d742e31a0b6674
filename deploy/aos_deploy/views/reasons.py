"""A decision explained for people, in eight lines at most."""

from aos_protocol.messages import Consequence, Flip, WhatIf, Why

_SHOWN_TERMS = 4
_LEAST_SHARE = 5e-5
"""The share of the largest difference from which on another one is told."""
_LONG_UPDATE_S = 0.1
"""The time that a decision usually has. A shorter update is in `--json` alone."""


def why_lines(why: Why) -> list[str]:
    lines = [_verdict(why), _expected(why)]
    lines += [_consequence(each) for each in why.expected if each.action or each.goal_probability][:3]
    lines += _terms(why)
    lines.append(_flips(why))
    if why.remark:
        lines.append(f"  remark: {why.remark}")
    return [line for line in lines if line]


def _verdict(why: Why) -> str:
    here = _worth(why.value, why.stderr)
    there = _worth(why.other_value, why.other_stderr)
    exact = "exactly " if why.is_exact else ""
    asked = {"operator": ", asked for by an operator,", "script": ", asked for by a script,"}
    chosen = why.action + asked.get(why.chosen_by, "")
    head = f"step {why.step}: {chosen} is worth {exact}{here}, {why.other} {there}"
    if not why.is_close:
        return f"{head}: margin {_worth(why.margin, why.margin_stderr)}"
    more = (
        f"about {_rounded(why.simulations_to_tell):,} simulations would tell"
        if why.simulations_to_tell
        else ("no number of simulations is sure to tell")
    )
    return f"{head}: too close to call, {more}"


def _rounded(number: int) -> int:
    """Two digits: nobody knows more of what a search will need."""
    return int(float(f"{number:.2g}"))


def _worth(value: float, stderr: float) -> str:
    """`+2.713 ± 0.04`; an error that no shown digit of the value has is left out."""
    is_shown = stderr > 1e-4 * abs(value)
    return f"{value:+.4g}" + (f" ± {stderr:.2g}" if is_shown else "")


def _expected(why: Why) -> str:
    likely = ", ".join(f"{each.response} {each.probability:.1%}" for each in why.expected)
    seen = next((each for each in why.expected if each.is_seen), None)
    came = f"; {seen.response} was seen" if seen is not None else ""
    return f"  expected: {likely}{came}{_update(why)}" if likely else ""


def _update(why: Why) -> str:
    """Tells what the belief update took after the outcome, where that was long."""
    if why.update_s < _LONG_UPDATE_S:
        return ""
    effort = f": {why.update_effort}" if why.update_effort else ""
    return f"; the belief update took {why.update_s:.2g} s{effort}"


def _consequence(each: Consequence) -> str:
    goal = f"    after {each.response} the goal has probability {each.goal_probability:.3g}"
    if not each.action:
        return f"{goal}, and the mission would be over"
    return f"{goal}, and next would be {each.action}, worth {_worth(each.value, each.stderr)}"


def _terms(why: Why) -> list[str]:
    """The lines of documents that the margin comes from, and what of it is not told apart."""
    least = _LEAST_SHARE * max((abs(term.value - term.other) for term in why.terms), default=0.0)
    telling = [term for term in why.terms if abs(term.value - term.other) > least]
    shown = [f"{term.value - term.other:+.4g} from {term.place}" for term in telling[:_SHOWN_TERMS]]
    left = sum(term.value - term.other for term in telling[_SHOWN_TERMS:])
    if telling[_SHOWN_TERMS:]:
        shown.append(f"{left:+.4g} from {len(telling) - _SHOWN_TERMS} other lines")
    if not why.is_exact and why.terms:
        shown.append(f"{why.rest - why.other_rest:+.4g} from later steps")
    return [f"  the margin is {', '.join(shown)}"] if shown else []


def _flips(why: Why) -> str:
    if not why.flips:
        if why.remark or why.is_close:
            return ""
        found = "is known to make" if not why.is_exact else "makes"
        return f"  no probability of one value {found} {_better_elsewhere(why)} better"
    flip = why.flips[0]
    name = f"P({flip.variable}={flip.value})"
    if why.is_exact:
        return f"  {_better_elsewhere(why)} is better where {name} is {_side(flip)}, now {flip.now:.4g}"
    if flip.low <= 0 and flip.high >= 1:
        return f"  too close to call whatever {name} is, now {flip.now:.4g}"
    changes = "changes" if flip.is_checked else "may change"
    return f"  the choice {changes} where {name} is within {flip.low:.3g}-{flip.high:.3g}, now {flip.now:.4g}"


def _better_elsewhere(why: Why) -> str:
    """The action that is not the better one now: that may be what a person has asked for."""
    return why.action if why.margin < 0 else why.other


def _side(flip: Flip) -> str:
    """`below 0.412`, the side on which the choice is another one."""
    rises = (flip.low + flip.high) / 2 > flip.now
    if flip.is_checked and (flip.high >= 1 if rises else flip.low <= 0) and flip.high - flip.low <= 1e-3:
        return "1" if rises else "0"
    return f"above {flip.high:.4g}" if rises else f"below {flip.low:.4g}"


def what_if_lines(found: WhatIf) -> list[str]:
    """The lines of `aos whatif`: the decision then, what was supposed, the best other actions."""
    same = "still " if found.action == found.before else ""
    lines = [
        f"step {found.step}: {same}{found.action}, worth {_worth(found.value, found.stderr)}"
        + (f", instead of {found.before}, worth {found.value_before:+.4g}" if not same else "")
    ]
    lines += [f"  supposed {each}" for each in found.supposed]
    others = sorted(found.actions, key=lambda value: -value.q)
    told = [each for each in others if each.action != found.action and (each.n or not each.stderr)]
    if told:
        worth = (f"{each.action} {_worth(each.q, each.stderr)}" for each in told[:4])
        lines.append(f"  then {', '.join(worth)}")
    if found.remark:
        lines.append(f"  remark: {found.remark}")
    return lines
