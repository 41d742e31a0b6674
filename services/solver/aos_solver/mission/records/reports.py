"""The reports of a mission: states, decisions and outcomes, each in the journal before anybody hears it."""

from typing import Any

from msgspec.structs import replace

from aos_protocol import messages
from aos_protocol.mission_rows import DECISION, STATE
from aos_solver.child.answers.beliefs import BeliefUpdate
from aos_solver.mission.control.steering import Steering
from aos_solver.mission.decision.choices import Choice
from aos_solver.mission.models.takeover import RunningModel
from aos_solver.mission.ports import Ports
from aos_solver.mission.records.memory import MissionMemory
from aos_solver.mission.rules.drift import text_of
from aos_solver.mission.rules.endings import Ending


class Reports:
    """Numbers and dates what a mission tells. `state` is the mission's newest."""

    def __init__(self, state: messages.MissionState, ports: Ports, memory: MissionMemory) -> None:
        """The records go on where those in `memory` end."""
        self.state = state
        self._ports = ports
        self._sequence = memory.sequence
        self._goal_probability = memory.goal_probability
        self._steering = memory.steering

    def decided(
        self,
        choice: Choice,
        model: RunningModel,
        belief: messages.BeliefSummary,
        seed: int,
        constraints: tuple[messages.ConstraintRisk, ...],
        adopted: messages.ModelAdopted | None,
    ) -> messages.DecisionRecord:
        """Reports the decision for the next step, with the belief it was taken for; the record of it."""
        plan = choice.plan
        chosen = model.engine.description.actions[plan.index]
        record = messages.DecisionRecord(
            sequence=self._sequence,
            stamp_ns=self._ports.clock.now_ns(),
            mission=self.state.mission,
            epoch=self.state.epoch,
            step=self.state.step + 1,
            action=chosen.name,
            skill=chosen.skill,
            parameters=chosen.parameters,
            model_digest=model.digest,
            revision=model.revision,
            seed=seed,
            simulations=plan.simulations,
            horizon=plan.horizon,
            planning_s=plan.seconds,
            preparation_s=plan.preparation_s,
            actions=plan.actions,
            predicted=plan.predicted,
            belief=belief,
            planner=plan.planner,
            why=plan.why,
            threads=plan.threads,
            constraints=constraints,
            set_aside=choice.set_aside,
            is_cautious=choice.is_cautious,
            adopted=adopted,
            chosen_by=choice.chosen_by,
            searches=choice.searches,
            engine_starts=model.engine.starts,
            build_digest=model.engine.build_digest,
        )
        self._publish(record)
        return record

    def observed(
        self,
        decision: messages.DecisionRecord,
        outcome: messages.Outcome,
        update: BeliefUpdate,
        update_s: float,
        remark: str,
        drift: tuple[messages.ModelDrift, ...],
    ) -> messages.DecisionRecord:
        """Reports the outcome of a decision, and the belief after it; the `remark` is for people."""
        alarms = [text_of(alarm) for alarm in drift if alarm.is_new]
        remarks = (update.remark, remark, *_faults_of_monitors(outcome), *outcome.notices, *alarms)
        record = replace(
            decision,
            sequence=self._sequence,
            stamp_ns=self._ports.clock.now_ns(),
            epoch=self.state.epoch,
            belief=update.summary,
            outcome=outcome,
            surprise=update.surprise,
            update_s=update_s,
            update_effort=update.effort,
            adopted=None,
            is_impossible=update.is_impossible,
            remark="; ".join(text for text in remarks if text),
            drift=drift,
        )
        self._publish(record)
        return record

    def steered(self, steering: Steering) -> None:
        """Takes note of how the mission is steered now; `tell` and each other state tell of it."""
        self._steering = steering

    def tell(self, remark: str | None = None) -> None:
        """Reports the state once more, with what is new of it, and another remark where there is one."""
        self._change_state(**({} if remark is None else {"remark": remark}))

    def stand_at(self, step: int) -> None:
        """Takes up a mission at this step, which was reported before."""
        self.state = replace(self.state, step=step)

    def move_to(
        self, phase: str, step: int, model: RunningModel, belief: messages.BeliefSummary, remark: str
    ) -> None:
        """Reports another phase of the mission."""
        self._change_state(
            phase=phase,
            step=step,
            goal_probability=belief.goal_probability,
            remark=remark,
            revision=model.revision,
        )

    def end(self, ending: Ending, remark: str) -> None:
        """Reports the end of the mission, with the belief of the last record."""
        self._change_state(
            phase="ended", ending=ending.value, remark=remark, goal_probability=self._goal_probability
        )

    def _publish(self, record: messages.DecisionRecord) -> None:
        self._ports.journal(DECISION, record)
        self._sequence = record.sequence + 1
        self._goal_probability = record.belief.goal_probability
        self._ports.publish_record(record)

    def _change_state(self, **changes: Any) -> None:
        steering = self._steering
        is_over = changes.get("phase", self.state.phase) == "ended"
        self.state = replace(
            self.state,
            held_by="" if is_over else steering.held_by,
            left_out=dict(steering.left_out),
            asked=() if is_over else tuple(asked.action for asked in steering.queue),
            **changes,
        )
        self._ports.journal(STATE, self.state)
        self._ports.publish_state(self.state)


def overrun(update: BeliefUpdate, update_s: float, budget_s: float | None) -> str:
    """Tells people why an update took longer than a decision may; nothing where it did not."""
    if budget_s is None or update_s <= budget_s:
        return ""
    over = f"the update took {update_s:.2g} s, more than a decision's {budget_s:g} s"
    return f"{over}: {update.effort}" if update.effort else over


def _faults_of_monitors(outcome: messages.Outcome) -> list[str]:
    """Tells people of monitors that gave nothing."""
    return [f"the monitor {name} failed: {text}" for name, text in outcome.monitor_faults.items()]
