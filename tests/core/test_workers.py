"""Workers: order, share done, failures."""

import time

import pytest

from ves_twin.core.workers import Workers


@pytest.mark.slow
def test_jobs_come_back_in_order_and_failures_come_through():
    shares: list[float] = []
    with Workers(2) as workers:
        assert workers.collect(abs, [-3, 1, -2], shares.append) == [3, 1, 2]
        assert shares == [pytest.approx(n / 3) for n in (1, 2, 3)]
        with pytest.raises(ValueError, match="invalid literal"):
            workers.collect(int, ["1", "x"])


def later(seconds: float) -> float:
    time.sleep(seconds)
    return seconds


@pytest.mark.slow
@pytest.mark.parametrize(("count", "order"), [(1, [0, 1, 2]), (2, [1, 2, 0])])
def test_jobs_come_as_they_end_each_with_its_number(count, order):
    """The long one keeps no other waiting; one process works in order."""
    jobs = [3.0, 0.0, 0.1]
    with Workers(count) as workers:
        found = list(workers.as_done(later, jobs))
        assert [n for n, _ in found] == order
        assert all(result == jobs[n] for n, result in found)
        with pytest.raises(ValueError, match="invalid literal"):
            list(workers.as_done(int, ["1", "x"]))
