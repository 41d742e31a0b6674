"""The metrics of missions by name, and what a decision record adds to them."""

from aos_gateway.metrics.exposition import Counter, Family, Gauge, Histogram
from aos_protocol.errors import ANOTHER_MAY_MOVE
from aos_protocol.messages import DecisionRecord

_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0)
_NATS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0)


class Families:
    """All metrics. Sums have the label `robot`, and none has a mission, so that there are few of them."""

    def __init__(self) -> None:
        self.missions = Counter("aos_missions_total", "Missions that have ended, by ending.")
        self.running = Gauge("aos_missions_running", "Missions that go on.")
        self.holding = Gauge("aos_missions_holding", "Missions that go on and hold.")
        self.goal = Gauge("aos_goal_probability", "Probability of the goal in the belief of a mission.")
        self.steps = Counter("aos_steps_total", "Steps whose outcome is known.")
        self.decision_s = Histogram(
            "aos_decision_seconds", "Seconds that a decision took, by who chose the action.", _SECONDS
        )
        self.simulations = Counter("aos_simulations_total", "Simulations of all searches.")
        self.surprise = Histogram(
            "aos_surprise_nats",
            "Surprise of outcomes: -log of the predicted probability, or of a density where numbers came.",
            _NATS,
        )
        self.impossible = Counter(
            "aos_impossible_outcomes_total", "Outcomes that the model says cannot be, by skill."
        )
        self.failures = Counter(
            "aos_skill_failures_total",
            "Activations that failed, by skill and status; `observed` where a rule tells a failure.",
        )
        self.activations = Counter("aos_activations_total", "Activations that are over, by skill.")
        self.holds = Counter("aos_holds_total", "Holds, for an operator or for a skill that cannot be run.")
        self.engine_restarts = Counter(
            "aos_engine_restarts_total", "New starts of engines that had ended, or whose search was given up."
        )
        self.service_restarts = Counter(
            "aos_service_restarts_total", "New starts of services that had ended, by service."
        )
        self.drift = Counter(
            "aos_drift_alarms_total", "Alarms that a skill does not report what its model predicts."
        )
        self.unreadable = Counter(
            "aos_unreadable_runs_total", "Scrapes at which the records of a run could not be read."
        )
        self.all: tuple[Family, ...] = tuple(
            family for family in vars(self).values() if isinstance(family, Family)
        )

    def take(self, robot: str, record: DecisionRecord, engine_starts: dict[str, int]) -> None:
        """Counts a record. `engine_starts` has those known of the run's models, and is brought up to date."""
        before = engine_starts.get(record.model_digest, 1)
        again = record.engine_starts - (before if record.engine_starts >= before else 1)
        self.engine_restarts.add(again, robot=robot)
        engine_starts[record.model_digest] = record.engine_starts
        if record.outcome is None:
            self._take_decision(robot, record)
            return
        self.steps.add(robot=robot)
        self.activations.add(robot=robot, skill=record.skill)
        code = "" if record.outcome.fault is None else record.outcome.fault.code
        has_failed = record.outcome.status != "observed" or code != ""
        if has_failed and code != ANOTHER_MAY_MOVE:
            self.failures.add(robot=robot, skill=record.skill, status=record.outcome.status)
        if record.is_impossible:
            self.impossible.add(robot=robot, skill=record.skill)
        elif record.outcome.status == "observed":
            self.surprise.observe(record.surprise, robot=robot)
        for alarm in record.drift:
            if alarm.is_new:
                self.drift.add(robot=robot, skill=alarm.skill, response=alarm.response)

    def forget_gauges(self) -> None:
        """Forgets what held at the scrape before."""
        for family in self.all:
            if isinstance(family, Gauge):
                family.clear()

    def _take_decision(self, robot: str, record: DecisionRecord) -> None:
        self.decision_s.observe(record.planning_s, robot=robot, chosen_by=record.chosen_by)
        made = sum(sum(search.simulations) for search in record.searches)
        self.simulations.add(made, robot=robot)
