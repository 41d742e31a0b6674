import dataclasses
from collections import Counter, defaultdict
from statistics import fmean
from typing import Any

from .answers import Answers, lists, lists_of_lists
from .problem import Problem

MEAN_TARGET, WORST_TARGET = 0.01, 0.10
"""A planner may lose this much more of the range than exact look-ahead."""

SOUND_LOOK_AHEAD = 0.02
"""Look-ahead that is near the optimum loses at most this much. Where it loses more, it plans beyond the
mission's end."""


def _family(problem: Problem) -> str:
    return problem.name.partition("/")[0]


@dataclasses.dataclass
class Bounds(Answers):
    """Claims, false ones, and the models with any."""

    models: int = 0
    claims: int = 0
    false: Counter[str] = dataclasses.field(default_factory=Counter)
    false_models: list[str] = dataclasses.field(default_factory=list)
    planners: Counter[str] = dataclasses.field(default_factory=Counter)

    def add(self, problem: Problem, answer: dict[str, Any]) -> bool:
        self.models += 1
        if self.has_crashed(problem, answer, "claims"):
            return True
        self.claims += answer["claims"]
        self.planners.update(answer["planners"])
        self.false.update(_kind(finding) for finding in answer["false"])
        if answer["false"]:
            self.false_models.append(problem.name)
        return bool(answer["false"])

    def faults_text(self, problem: Problem, answer: dict[str, Any]) -> str:
        if "claims" not in answer:
            return f"{problem.name}: {answer.get('crash') or answer.get('fault')}"
        lines = [
            f"{problem.name} ({answer['states']} states), {finding['where']}: {_kind(finding)}: "
            f"{finding['said']}; it is between {_number(finding['lower'])} and {_number(finding['upper'])}"
            for finding in sorted(answer["false"], key=_is_rounding)[:3]
        ]
        more = len(answer["false"]) - len(lines)
        return "\n".join([*lines, f"  and {more} more"] if more > 0 else lines)

    def line(self) -> str:
        return f"{sum(self.false.values())} of {self.claims} claims false, {len(self.crashes)} crashes"

    def table(self) -> str:
        lines = [
            f"{self.models} models, {self.claims} claims: {sum(self.false.values())} false in "
            f"{len(self.false_models)} models; {len(self.crashes)} crashes",
            "  auto took " + ", ".join(f"{name} {count}" for name, count in self.planners.most_common()),
        ]
        lines += [f"  {count:5} {kind}" for kind, count in self.false.most_common()]
        return "\n".join(lines)

    def is_passed(self) -> bool:
        return not self.false and not self.crashes

    def as_json(self) -> dict[str, Any]:
        counts = {
            "models": self.models,
            "claims": self.claims,
            "false": self.false,
            "planners": self.planners,
        }
        return {**counts, "false_models": self.false_models, "crashes": self.crashes}


def _kind(finding: dict[str, Any]) -> str:
    claim = finding["claim"].partition(" of action")[0]
    return f"{claim} by {finding['who']}" if finding["who"] else claim


def _is_rounding(finding: dict[str, Any]) -> bool:
    return finding["claim"] in ("bounds as printed", "bounds cross by rounding")


def _number(value: float | None) -> str:
    return "nowhere" if value is None else f"{value:.6g}"


@dataclasses.dataclass
class Regrets(Answers):
    """Shares of the range that planners lose, by family and planner."""

    regrets: dict[str, dict[str, list[float]]] = dataclasses.field(default_factory=lists_of_lists)
    worst: dict[str, list[tuple[float, str]]] = dataclasses.field(default_factory=lists)
    sound: dict[str, list[tuple[float, str]]] = dataclasses.field(default_factory=lists)
    by_decisions: dict[str, list[float]] = dataclasses.field(default_factory=lists)
    times: dict[str, list[float]] = dataclasses.field(default_factory=lists)
    """The processor time of each decision, in seconds."""

    used: dict[str, Counter[str]] = dataclasses.field(default_factory=lambda: defaultdict(Counter))
    rejected: Counter[str] = dataclasses.field(default_factory=Counter)

    def add(self, problem: Problem, answer: dict[str, Any]) -> bool:
        """Returns whether a planner lost much."""
        if self.has_crashed(problem, answer, "optimum"):
            return True
        if answer["obstacle"]:
            self.rejected[answer["obstacle"]] += 1
            return False
        played = {entry["planner"]: entry for entry in answer["planners"]}
        reference = max(played["look-ahead"]["regret"], 0.0) if "look-ahead" in played else 0.0
        is_bad = False
        for name, entry in played.items():
            self.regrets[_family(problem)][name].append(entry["regret"])
            self.by_decisions[name].append(entry["by_decisions"])
            self.times[name] += entry["times"]
            self.used[name][entry["used"]] += 1
            if name != "look-ahead":
                # A model in which look-ahead itself goes wrong makes up for no other.
                excess = max(entry["regret"] - reference, 0.0)
                self.worst[name].append((excess, problem.name))
                if reference <= SOUND_LOOK_AHEAD:
                    self.sound[name].append((excess, problem.name))
                is_bad |= excess > WORST_TARGET or bool(entry["fault"])
        return is_bad

    def faults_text(self, problem: Problem, answer: dict[str, Any]) -> str:
        if "optimum" not in answer:
            return f"{problem.name}: {answer.get('crash') or answer.get('fault')}"
        head = (
            f"{problem.name} ({answer['states']} states, {answer['actions']} actions, "
            f"{answer['steps']} steps): optimum {answer['optimum']:.6g}, random {answer['random']:.6g}"
        )
        lines = [head]
        for entry in answer["planners"]:
            share = f"{100 * entry['regret']:.1f} % +- {100 * entry['standard_error']:.1f}"
            decisions = f"{100 * entry['by_decisions']:.1f} % by its decisions"
            lines.append(f"  {entry['planner']} loses {share}, {decisions} ({entry['used']}; {entry['why']})")
            lines.append(f"    {entry['worst_actions'][:80]} {entry['fault']}")
        return "\n".join(lines)

    def line(self) -> str:
        return ", ".join(
            f"{name} {100 * fmean(excess for excess, _ in found):.1f} %" for name, found in self.worst.items()
        )

    def table(self) -> str:
        names = sorted({name for family in self.regrets.values() for name in family})
        lines = ["regret in % of the range from random actions to the optimum: mean, worst"]
        lines.append(f"  {'family':12}{'models':>7}" + "".join(f"{name:>22}" for name in names))
        everything: dict[str, list[float]] = defaultdict(list)
        for family, found in sorted(self.regrets.items()):
            cells = ""
            for name in names:
                everything[name] += found[name]
                cells += f"{100 * fmean(found[name]):12.1f}{100 * max(found[name]):10.1f}"
            lines.append(f"  {family:12}{len(next(iter(found.values()))):7}{cells}")
        cells = "".join(
            f"{100 * fmean(all_):12.1f}{100 * max(all_):10.1f}"
            for all_ in (everything[n] for n in names)
            if all_
        )
        lines.append(f"  {'all':12}{max((len(a) for a in everything.values()), default=0):7}{cells}")
        for name in self.worst:
            began = ", ".join(f"{used} {count}" for used, count in self.used[name].most_common())
            lines += [
                f"  {name} beyond look-ahead: {_mean_and_worst(self.worst[name])}; "
                f"its decisions by themselves lose {100 * fmean(self.by_decisions[name]):.2f} %",
                f"    where look-ahead is near the optimum ({len(self.sound[name])} models): "
                f"{_mean_and_worst(self.sound[name])}",
                f"    {_times_text(self.times[name])}; began with {began}",
            ]
        lines += [f"  {count} models left out: {why}" for why, count in self.rejected.items()]
        lines += self.crash_lines("  ")
        return "\n".join(lines)

    def is_passed(self) -> bool:
        return not self.crashes and all(
            fmean(excess for excess, _ in found) <= MEAN_TARGET and max(found)[0] <= WORST_TARGET
            for found in self.worst.values()
        )

    def as_json(self) -> dict[str, Any]:
        beyond = {name: [excess for excess, _ in found] for name, found in self.worst.items()}
        return {
            "regrets": self.regrets,
            "beyond_look_ahead": {
                name: {"mean": fmean(excesses), "worst": max(excesses)} for name, excesses in beyond.items()
            },
            "rejected": self.rejected,
            "crashes": self.crashes,
        }


def _times_text(times_s: list[float]) -> str:
    ranked = sorted(1000 * time_s for time_s in times_s)
    half, most = (ranked[int(share * (len(ranked) - 1))] for share in (0.5, 0.95))
    shares = f"50 % within {half:.0f} ms, 95 % within {most:.0f} ms, longest {ranked[-1]:.0f} ms"
    return f"{len(ranked)} decisions: {shares}"


def _mean_and_worst(excesses: list[tuple[float, str]]) -> str:
    if not excesses:
        return "none"
    worst, model = max(excesses)
    return f"mean {100 * fmean(excess for excess, _ in excesses):.2f} %, worst {100 * worst:.1f} % ({model})"
