"""The words of a command that Ctrl-C ends among missions."""

from contextlib import AbstractContextManager

from rich.progress import Progress

from aos_deploy.printing import count
from aos_deploy.terminal import interruption_told


def interruption_among_missions(bar: Progress, *, are_kept: bool) -> AbstractContextManager[None]:
    """Ends the command at Ctrl-C, and says how many of the missions of the bar's last task have ended."""
    after = (
        "the same command goes on from there"
        if are_kept
        else "with --keep DIR the same command would go on from there"
    )

    def text() -> str:
        if not bar.tasks:
            return "stopped before the first mission"
        task = bar.tasks[-1]
        missions = count(int(task.total or 0), "mission")
        return f"stopped in {task.description} after {int(task.completed)} of its {missions}; {after}"

    return interruption_told(text)
