from aos_deploy.processes.consequence import STARTS, STARTS_OF_ADAPTER, WITHIN_S, Restarts


def test_starts_wait_longer_and_longer_until_a_minute_is_over():
    restarts = Restarts()
    waits_s = []
    for now_s in range(STARTS):
        assert restarts.are_left(now_s)
        restarts.start(now_s)
        restarts.succeed()
        waits_s.append(restarts.delay_s(now_s))
    assert waits_s == [0.2, 0.4, 0.8, 1.6, 3.2]
    assert not restarts.are_left(STARTS)
    assert restarts.are_left(WITHIN_S + 1)


def test_an_adapter_that_has_served_has_more_starts_than_one_that_never_does():
    in_vain, served = Restarts(is_adapter=True), Restarts(is_adapter=True)
    for now_s in range(STARTS):
        in_vain.start(now_s)
        served.start(now_s)
        served.succeed()
    assert not in_vain.are_left(STARTS)
    for now_s in range(STARTS, STARTS_OF_ADAPTER):
        assert served.are_left(now_s)
        served.start(now_s)
        served.succeed()
    assert not served.are_left(STARTS_OF_ADAPTER)


def test_a_connection_that_was_there_is_made_again_at_once_and_one_that_fails_later():
    restarts = Restarts()
    for now_s in range(4):
        restarts.start(now_s)
        restarts.succeed()
        assert restarts.delay_s(now_s, is_cut=True) == 0.0
    restarts.start(4)
    restarts.start(5)
    assert restarts.delay_s(5, is_cut=True) == 0.4
