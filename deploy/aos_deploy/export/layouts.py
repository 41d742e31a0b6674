"""Layouts for viewers of an MCAP file: Foxglove and Lichtblick as JSON, PlotJuggler as XML."""

from collections.abc import Iterable, Sequence
from typing import Any
from xml.etree import ElementTree as ET

from aos_deploy.export.mcap_file import PICTURE
from aos_deploy.export.plotted import BELIEF, VALUES, plain_name
from aos_protocol.messages import DecisionRecord

_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#ff7f0e", "#9467bd", "#17becf", "#8c564b", "#e377c2")
_MOST_CURVES = 24
"""A plot of more curves than that shows nothing."""


class Curves:
    """The fields of a run that are worth a curve: each path as `(topic, field, field)`."""

    def __init__(self) -> None:
        self.endings = [
            (BELIEF, name) for name in ("goal_probability", "failure_probability", "over_probability")
        ]
        self.surprise = [(BELIEF, "surprise"), (BELIEF, "entropy")]
        self.belief: list[tuple[str, ...]] = []
        self.numbers: list[tuple[str, ...]] = []
        self.values: list[tuple[str, ...]] = []

    @property
    def plots(self) -> dict[str, list[tuple[str, ...]]]:
        """The curves of each plot, by its title."""
        numbers = {"Numbers of the belief": self.numbers[:_MOST_CURVES]} if self.numbers else {}
        return {
            "Endings": list(self.endings),
            "Belief": self.belief[:_MOST_CURVES],
            **numbers,
            "Values of the actions": self.values[:_MOST_CURVES],
            "Surprise and entropy": list(self.surprise),
        }


def curves_of(records: Iterable[DecisionRecord]) -> Curves:
    """The curves of a run: of its belief those that change."""
    curves = Curves()
    first: dict[tuple[str, ...], float] = {}
    for record in records:
        for marginal in record.belief.marginals:
            if marginal.quantiles:
                _add_number(curves.numbers, plain_name(marginal.variable))
                continue
            for value, probability in marginal.values.items():
                path: tuple[str, ...] = (
                    BELIEF,
                    "probability",
                    plain_name(marginal.variable),
                    plain_name(value),
                )
                if (
                    abs(first.setdefault(path, probability) - probability) > 0.01
                    and path not in curves.belief
                ):
                    curves.belief.append(path)
        for action in record.actions:
            path = (VALUES, "q", plain_name(action.action))
            if path not in curves.values:
                curves.values.append(path)
    return curves


def _add_number(numbers: list[tuple[str, ...]], variable: str) -> None:
    """Adds the median of a number and what 90 % lie between."""
    paths: list[tuple[str, ...]] = [(BELIEF, "quantiles", variable, each) for each in ("p05", "p50", "p95")]
    if paths[0] not in numbers:
        numbers.extend(paths)


def foxglove_layout(curves: Curves, *, has_pictures: bool) -> dict[str, Any]:
    """The layout that Foxglove and Lichtblick import."""
    panels: dict[str, dict[str, Any]] = {}
    plots = []
    for number, (title, paths) in enumerate(curves.plots.items()):
        name = f"Plot!aos{number}"
        shown = [
            {"value": f"{path[0]}.{'.'.join(path[1:])}", "enabled": True, "timestampMethod": "receiveTime"}
            for path in paths
        ]
        panels[name] = {
            "title": title,
            "paths": shown,
            "showLegend": True,
            "legendDisplay": "left",
            "isSynced": True,
            "xAxisVal": "timestamp",
        }
        plots.append(name)
    panels["StateTransitions!aos"] = {
        "isSynced": True,
        "paths": [
            {"value": path, "label": label, "timestampMethod": "receiveTime"}
            for label, path in (
                ("phase", "/aos/mission.phase"),
                ("action", "/aos/intended.skill"),
                ("response", "/aos/outcome.response"),
                ("chosen by", f"{VALUES}.chosen_by"),
            )
        ],
    }
    panels["RawMessages!aos"] = {"topicPath": "/aos/decision"}
    right = ["RawMessages!aos"]
    if has_pictures:
        panels["Image!aos"] = {"imageMode": {"imageTopic": PICTURE}, "cameraTopic": PICTURE}
        right.insert(0, "Image!aos")
    left = _stacked(["StateTransitions!aos", *plots])
    layout = {"direction": "row", "first": left, "second": _stacked(right), "splitPercentage": 65}
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": layout,
    }


def _stacked(panels: Sequence[str]) -> Any:
    """Panels of equal height, one above the other."""
    if len(panels) == 1:
        return panels[0]
    share = 100 / len(panels)
    return {
        "direction": "column",
        "first": panels[0],
        "second": _stacked(panels[1:]),
        "splitPercentage": share,
    }


def plotjuggler_layout(curves: Curves) -> str:
    """The layout that PlotJuggler loads; its names of curves are topic and fields with / between them."""
    root = ET.Element("root")
    tabs = ET.SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    tab = ET.SubElement(tabs, "Tab", tab_name="mission", containers="1")
    plots = curves.plots
    sizes = ";".join([f"{1 / len(plots):.6f}"] * len(plots))
    container = ET.SubElement(tab, "Container")
    splitter = ET.SubElement(container, "DockSplitter", orientation="-", sizes=sizes, count=str(len(plots)))
    for title, paths in plots.items():
        area = ET.SubElement(splitter, "DockArea", name=title)
        plot = ET.SubElement(area, "plot", mode="TimeSeries", style="Steps")
        for number, path in enumerate(paths):
            ET.SubElement(plot, "curve", name="/".join(path), color=_COLOURS[number % len(_COLOURS)])
    ET.SubElement(tabs, "currentTabIndex", index="0")
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
