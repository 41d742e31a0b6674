"""The order of decision records that come out of a stream and out of a history."""

from aos_protocol.messages import DecisionRecord, History


class DecisionFeed:
    """Puts records into order: each sequence number once, ascending; what follows a gap is held back.

    A record of another mission starts again from its first.
    """

    def __init__(self) -> None:
        self.next_sequence = 0
        self._mission = ""
        self._ahead: dict[int, DecisionRecord] = {}

    @property
    def has_gap(self) -> bool:
        """True while records are held back for one that is missing."""
        return bool(self._ahead)

    def take(self, record: DecisionRecord) -> list[DecisionRecord]:
        """The records that can be given now that this one is here."""
        if record.mission != self._mission:
            self._mission = record.mission
            self.next_sequence = 0
            self._ahead.clear()
        if record.sequence >= self.next_sequence:
            self._ahead[record.sequence] = record
        ready: list[DecisionRecord] = []
        while self.next_sequence in self._ahead:
            ready.append(self._ahead.pop(self.next_sequence))
            self.next_sequence += 1
        return ready

    def take_history(self, history: History) -> list[DecisionRecord]:
        """Does what `take` does, for all records of an answer."""
        return [ready for record in history.records for ready in self.take(record)]
