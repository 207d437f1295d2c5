"""Beside: jobs in order, and what they raise reaches their owner."""

import threading

import pytest

from ves_twin.simulator.beside import Beside, _Job


def test_a_job_waits_for_the_one_before():
    beside, go, done = Beside(), threading.Event(), []
    beside.start(lambda: (go.wait(), done.append("first")))
    assert done == []
    go.set()
    beside.start(lambda: done.append("second"))
    beside.wait()
    assert done == ["first", "second"]


def test_what_a_job_raises_reaches_its_owner_once_and_the_next_is_not_begun():
    beside, done = Beside(), []

    def refuses() -> None:
        raise OSError("disk full")

    beside.start(refuses)
    with pytest.raises(OSError, match="disk full"):
        beside.start(lambda: done.append("not begun"))
    beside.wait()
    assert done == []


def test_a_job_that_a_fork_left_without_its_thread_is_done_by_who_waits():
    beside, done = Beside(), []
    beside._job = _Job(lambda: done.append("rows"))
    beside._job.join = lambda: None  # as in the child of a fork: the thread is gone
    beside.wait()
    assert done == ["rows"]


def test_nothing_to_wait_for_is_no_error():
    Beside().wait()
