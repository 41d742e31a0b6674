"""Model against reality: the sequential tests of what skills report, and their alarms."""

from aos_protocol.messages.base import Message


class ModelDrift(Message, frozen=True):
    """An alarm: a skill's response comes more often, or more rarely, than the model predicts.

    Of so many `uses`, the share `seen` had this response; the mean of the probabilities predicted for it
    before each of them is `modelled`. With `is_new` the alarm has begun with this use, and it stays.
    """

    skill: str
    response: str
    modelled: float
    seen: float
    uses: int
    is_new: bool = False


class DriftTest(Message, frozen=True):
    """The state of the test of one response: its uses, how often it was seen, the sum of the predicted
    probabilities, and the logarithms of what each bet has won."""

    skill: str
    response: str
    uses: int = 0
    seen: int = 0
    expected: float = 0.0
    log_wealth: tuple[float, ...] = ()
    is_alarm: bool = False


class DriftTests(Message, frozen=True):
    """The journal's row with which a model's tests begin, or go over from the mission before.

    `count` is the number of tests that are not each other's complements: all share one rate of false alarms.
    """

    model_digest: str
    count: int
    tests: tuple[DriftTest, ...]
