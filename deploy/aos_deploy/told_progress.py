"""A progress that tells its steps in lines, where there is no terminal to draw a bar on."""

from contextlib import ExitStack
from typing import Any

from rich.progress import Progress, TaskID

from aos_deploy.timed_lines import TimedLines


class ToldProgress(Progress):
    """Counts as a bar does, and draws nothing: a line now and then tells how far the last task is,
    also while nothing moves on."""

    def __init__(self) -> None:
        super().__init__(disable=True)
        self._lines = TimedLines("working")
        self._clock = ExitStack()

    def start(self) -> None:
        super().start()
        self._clock.enter_context(self._lines.ticking())

    def stop(self) -> None:
        self._clock.close()
        super().stop()

    def add_task(self, description: str, *args: Any, **fields: Any) -> TaskID:
        task_id = super().add_task(description, *args, **fields)
        self._tell(task_id)
        return task_id

    def update(self, task_id: TaskID, **changes: Any) -> None:
        super().update(task_id, **changes)
        self._tell(task_id)

    def advance(self, task_id: TaskID, advance: float = 1) -> None:
        super().advance(task_id, advance)
        self._tell(task_id)

    def _tell(self, task_id: TaskID) -> None:
        task = next(task for task in self.tasks if task.id == task_id)
        of_all = f" of {task.total:,.0f}" if task.total else ""
        self._lines.tell(f"{task.description}: {task.completed:,.0f}{of_all}")
