"""The rule `replay`: the outcomes of a run's journal once more, through engines of the run's documents."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import msgspec

from aos_deploy.history_check.check import Violation
from aos_deploy.runs.studied import StudiedRun
from aos_protocol.errors import AosError
from aos_protocol.messages import BeliefSummary, DecisionRecord
from aos_runtime.disk.mission_folders import JOURNAL, mission_folders


class Replay(msgspec.Struct):
    """The violations of the rule, how many records were compared, and why others were not."""

    violations: list[Violation] = []
    compared: int = 0
    remark: str = ""


async def replayed(run: Path, on_progress: Callable[[str], None]) -> Replay:
    """Replays the journals of a run that is over.

    A run that cannot be replayed, or not to its end, has the reason as the remark.
    """
    replay = Replay()
    remarks: Counter[str] = Counter()
    folders = [str((folder / JOURNAL).relative_to(run)) for folder in mission_folders(run).values()]
    for file in folders or [JOURNAL]:
        replay.remark = ""
        try:
            await _replay(run, file, replay, on_progress)
        except (AosError, OSError) as error:
            replay.remark = error.message if isinstance(error, AosError) else str(error)
        remarks[replay.remark] += 1
    if folders:
        texts = (f"{number} of {len(folders)} missions: {text}" for text, number in remarks.items() if text)
        replay.remark = "; ".join(texts)
    return replay


async def _replay(run: Path, file: str, replay: Replay, on_progress: Callable[[str], None]) -> None:
    studied = StudiedRun.of_journal(run, file)
    if not any(record.belief.digest for record in studied.mission.of_kind(DecisionRecord)):
        replay.remark = "no belief of the journal has a digest"
        return
    async with studied.replay(on_progress) as remade:
        async for row, record, belief, _ in remade.rows():
            if isinstance(record, DecisionRecord) and record.belief.digest and belief.digest:
                replay.compared += 1
                if record.belief.digest != belief.digest:
                    replay.violations.append(Violation("replay", file, row, _text(record, belief)))


def _text(record: DecisionRecord, belief: BeliefSummary) -> str:
    when = "decided with" if record.outcome is None else "observed as"
    return f"step {record.step} is {when} the belief {record.belief.digest}; its replay gives {belief.digest}"
