"""Budget: stages end at their share, what is left out is kept once."""

import pickle

import pytest

from ves_twin.core.budget import Budget, EndedError
from ves_twin.core.errors import InvalidInputError


class Clock:
    """A clock that is set by hand [s]."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_stage_is_over_where_its_share_is_spent_and_names_what_it_leaves_out():
    clock = Clock()
    budget = Budget(2.0, clock)
    budget.stage(0.5)
    clock.now += 59.0
    assert not budget.skips("pairs")
    clock.now += 1.0
    assert budget.skips("pairs")
    assert budget.skips("pairs")
    assert budget.left_out == ["pairs"]
    budget.stage(1.0)
    assert budget.spent == pytest.approx(0.5)
    assert not budget.over


def test_without_minutes_nothing_is_ever_left_out():
    assert not pickle.loads(pickle.dumps(Budget())).over


@pytest.mark.parametrize("minutes", [0.0, -1.0, float("nan")])
def test_minutes_must_be_above_zero(minutes):
    with pytest.raises(InvalidInputError, match="minutes"):
        Budget(minutes)


def test_work_that_tells_nothing_yet_is_not_ended_and_other_work_is_with_all_its_stages():
    budget = Budget()
    assert not budget.end()
    assert not budget.over
    budget.stop_if_ended()
    budget.tells = True
    assert budget.end()
    assert budget.skips("better fits")
    budget.stage(float("inf"))  # a law that was asked for may take all the time there is
    assert budget.over
    with pytest.raises(EndedError):
        budget.stop_if_ended()
    assert pickle.loads(pickle.dumps(budget)).over
