"""Progress: a log tells stage, share and time left; quick work says nothing."""

import os
import signal
import time

import pytest

from ves_twin.cli import progress
from ves_twin.cli.progress import RunProgress


@pytest.fixture
def impatient(monkeypatch):
    """Lines come at once, so that a test need not wait for them."""
    monkeypatch.setattr(progress, "FIRST", 0.0)
    monkeypatch.setattr(progress, "PAUSE", 0.01)


@pytest.fixture
def now(monkeypatch):
    """A clock that a test sets [s]."""
    time_now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: time_now[0])
    return time_now


def _lines_with(word, capsys):
    """What was printed, once a line has a word; a slow machine has 30 s for it."""
    told = ""
    for _ in range(3000):
        told += capsys.readouterr().err
        if word in told:
            return told
        time.sleep(0.01)
    raise AssertionError(told)


def test_a_log_names_stage_share_and_time_left(impatient, capsys):
    with RunProgress("diagnose", 1.0, unit="share") as bar:
        bar.share(0.25, "signatures")
        told = _lines_with("diagnose: signatures, 25 %", capsys)
    assert "so far" in told
    assert "left in this stage" in told


def test_a_stage_without_news_is_told_all_the_same(impatient, capsys):
    with RunProgress("compare", 1.0, unit="share"):
        assert "compare, 0 %, 0 s so far" in _lines_with("compare", capsys)


def test_a_stage_whose_end_nobody_knows_tells_its_own_time(now):
    bar = RunProgress("diagnose", 1.0, unit="share")
    bar.share(0.7, "signatures")
    now[0] = 110.0
    bar.share(0.0, "choosing causes")
    assert bar.line() == "diagnose: choosing causes, 10 s so far"
    now[0] = 145.0
    assert bar.line() == "diagnose: choosing causes, 45 s so far, 35 s in this stage"


def test_a_stage_that_is_over_tells_for_how_long(now):
    bar = RunProgress("diagnose", 1.0, unit="share")
    bar.share(0.5, "signatures")
    now[0] = 110.0
    bar.share(1.0, "signatures")
    assert bar.line() == "diagnose: signatures, 100 %, 10 s so far"
    now[0] = 135.0
    assert bar.line() == "diagnose: signatures, 100 %, 35 s so far, 25 s since then"


def test_quick_work_prints_no_line(capsys, monkeypatch):
    monkeypatch.setattr(progress, "FIRST", 60.0)
    with RunProgress("run", 2.0) as bar:
        bar(2.0)
    assert capsys.readouterr().err == ""


def test_another_stage_begins_its_own_time(now):
    bar = RunProgress("plan", 1.0, unit="share")
    bar.share(0.5, "first")
    now[0] = 160.0
    bar.share(0.0, "second")
    now[0] = 170.0
    bar.share(0.5, "second")
    assert bar.line() == "plan: second, 50 %, 1 min 10 s so far, about 10 s left in this stage"


def _interrupted(asks: signal.Signals):
    with RunProgress("run", 2.0) as bar:
        bar(0.5)
        os.kill(os.getpid(), asks)
        time.sleep(0.05)
        bar(1.0)


@pytest.mark.parametrize("asks", progress.ASKS)
def test_ctrl_c_and_what_batch_systems_send_stop_between_two_slices(asks):
    before = signal.getsignal(asks)
    with pytest.raises(KeyboardInterrupt):
        _interrupted(asks)
    assert signal.getsignal(asks) is before


def _pressed(bar: RunProgress) -> None:
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(0.05)
    bar(0.5)


def test_the_first_ctrl_c_ends_work_that_has_something_to_tell_and_the_second_stops_it(capsys):
    ended = []

    def end() -> bool:
        ended.append(True)
        return True

    with RunProgress("diagnose", 1.0, ending=end) as bar:
        bar(0.1)
        _pressed(bar)
        assert progress.ENDING in capsys.readouterr().err
        with pytest.raises(KeyboardInterrupt):
            _pressed(bar)
    assert ended == [True]


def test_ctrl_c_stops_work_that_has_nothing_to_tell_yet():
    with RunProgress("diagnose", 1.0, ending=lambda: False) as bar:
        bar(0.1)
        with pytest.raises(KeyboardInterrupt):
            _pressed(bar)


@pytest.mark.parametrize(
    ("seconds", "text"), [(8.2, "8 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min")]
)
def test_times_read_as_people_say_them(seconds, text):
    assert progress._span(seconds) == text
