"""By plain squares, rows counted as far as they are independent, what is hidden is chosen."""

import numpy as np
import pytest
from linear import KINDS, Linear, drawn, halves

from ves_twin.diagnosis.build_up.memory import independent_rows
from ves_twin.diagnosis.build_up.plain_selector import PlainSelector

PLANT = Linear(KINDS)


def chosen_of(regression, begin=()):
    return {regression.trials[n].cause.label for n in PlainSelector(regression).run(begin)}


@pytest.mark.parametrize("seed", range(4))
def test_what_is_hidden_is_chosen_and_hardly_more(seed):
    hidden = drawn(np.random.default_rng(60 + seed), 5)
    found = chosen_of(halves(PLANT, hidden, 60 + seed).regression)
    assert {name.removesuffix(":size") for name in hidden} <= found
    assert len(found) <= len(hidden) + 1


def test_of_machines_in_order_coloured_error_alone_is_hardly_ever_a_cause():
    """A price of odds of one in all causes; 3 of 12 would be a choice without one."""
    found = [chosen_of(halves(PLANT, {}, 80 + seed).regression) for seed in range(12)]
    assert sum(map(len, found)) <= 2


def test_what_it_begins_with_goes_where_it_is_not_there():
    hidden = {"viscous@a:size": 0.6, "coulomb@b:size": 0.8}
    regression = halves(PLANT, hidden, 70).regression
    labels = [trial.cause.label for trial in regression.trials]
    wrong = [labels.index("drag@b"), labels.index("viscous@a")]
    assert chosen_of(regression, wrong) == {"viscous@a", "coulomb@b"}


def test_plain_sizes_are_those_of_weighted_squares_with_their_prior():
    """(X'WX + 1)^-1 X'Wy, each channel by its own weight."""
    regression = halves(PLANT, {"viscous@a:size": 0.6}, 3).regression
    columns, scale = regression.design([2, 5])
    weights = np.array([3.0, 0.2])
    root = np.sqrt(weights) / regression.level
    design = (columns * root).reshape(len(columns), -1).T * scale
    hessian = design.T @ design + np.eye(len(scale))
    shares = np.linalg.solve(hessian, design.T @ (regression.half.target * root).ravel())
    found = regression.plain([2, 5], weights, 1.0)
    assert found.shares == pytest.approx(shares, rel=1e-3, abs=1e-6)
    left = regression.half.target - np.tensordot(shares * scale, columns, axes=1)
    assert found.rms == pytest.approx(regression.half.rms(left), rel=1e-4)


def test_channels_weigh_by_their_independent_rows():
    regression = halves(PLANT, {}, 4).regression
    scale = PlainSelector(regression)._scale([])
    columns, _ = regression.design([])
    fit = regression.plain([], scale.weights, 1.0)
    left = regression.half.target - np.tensordot(fit.shares * fit.scale, columns, axes=1)
    count = independent_rows(regression.half.runs, left)
    weights = count / regression.half.kept.sum(axis=0) * (regression.level / fit.rms) ** 2
    assert scale.weights == pytest.approx(weights, rel=0.02)
