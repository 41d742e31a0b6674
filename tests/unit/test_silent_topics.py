import logging

from aos_middleware.robot.silent_topics import CALLS, SilentTopics


def test_a_topic_on_which_nothing_comes_is_told_once_with_the_nearest_name(caplog):
    silent = SilentTopics()
    for _ in range(2 * CALLS):
        silent.take_call({"/gripper_stat": False}, ["gripper_state", "level"])

    assert caplog.messages == [
        f"no message has come on /gripper_stat in {CALLS} calls of skills. Did you mean `/gripper_state`?"
    ]
    assert caplog.records[0].levelno == logging.WARNING


def test_a_topic_that_has_spoken_is_not_told(caplog):
    silent = SilentTopics()
    silent.take_call({"/level": True}, ["level"])
    for _ in range(2 * CALLS):
        silent.take_call({"/level": False}, ["level"])

    assert caplog.messages == []
