"""Workers: order, share done, failures."""

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
