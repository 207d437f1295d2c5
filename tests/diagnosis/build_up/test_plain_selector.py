"""By plain squares, rows counted as far as they are independent, what is hidden is chosen."""

from dataclasses import replace

import numpy as np
import pytest
from linear import KINDS, Linear, Narrow, drawn, halves

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


def test_of_machines_in_order_coloured_error_alone_is_no_cause():
    """Without a price twelve such machines got 14 names."""
    for seed in range(12):
        assert chosen_of(halves(PLANT, {}, 80 + seed).regression) == set()


@pytest.mark.parametrize("wrong", [("drag@b",), ("drag@b", "spring@a"), ("rotor@a", "offset@b")])
@pytest.mark.parametrize("known", [(), ("viscous@a",), ("viscous@a", "coulomb@b")])
def test_what_it_begins_with_goes_where_it_is_not_there(wrong, known):
    hidden = {"viscous@a:size": 0.6, "coulomb@b:size": 0.8}
    regression = halves(PLANT, hidden, 70).regression
    labels = [trial.cause.label for trial in regression.trials]
    begin = [labels.index(name) for name in (*known, *wrong)]
    assert chosen_of(regression, begin) == {"viscous@a", "coulomb@b"}


def test_of_causes_with_sizes_that_cannot_be_none_stays_and_none_takes_another_with_it():
    """Range of 0.1 for what would be 0.6: its twin of a wide range stands there."""
    hidden = {"viscous@a:size": 0.6, "viscous@b:size": 0.6, "coulomb@b:size": 0.8}
    plant = Narrow(("viscous", "twin", "coulomb", "offset"))
    regression = halves(plant, hidden, 8).regression
    labels = [trial.cause.label for trial in regression.trials]
    names = ("coulomb@b", "viscous@a", "viscous@b")
    found = chosen_of(regression, [labels.index(name) for name in names])
    assert found == {"coulomb@b", "twin@a", "twin@b"}


def test_the_right_variant_of_a_bent_cause_stays():
    hidden = {"gap@a:size": 0.35}
    regression = halves(Linear(("viscous", "gap")), hidden, 9, error=0.02).regression
    trials = regression.trials
    gaps = [n for n, trial in enumerate(trials) if trial.cause.label == "gap@a"]
    worst = max(gaps, key=lambda n: abs(trials[n].sizes[0] - 0.35))
    errors = {n: regression.plain_error([n]) for n in gaps}
    assert errors[worst] > min(errors.values()) + 0.05
    assert PlainSelector(regression).run([worst]) == [min(gaps, key=lambda n: errors[n])]


def test_a_channel_that_stands_still_decides_nothing():
    """What rounding leaves there is far below the declared noise."""
    regression = halves(PLANT, {"viscous@a:size": 0.6}, 70).regression
    half = regression.half
    still = replace(half, target=half.target * np.array([1.0, 0.0]))
    dust = replace(
        still,
        target=still.target + 1e-9 * np.random.default_rng(1).standard_normal(half.target.shape),
    )
    for one in (still, dust):
        found = chosen_of(replace(regression, half=one))
        assert "viscous@a" in found
        assert all(name.endswith("@a") for name in found)


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


def test_all_usual_frictions_are_offered_whether_they_pay_for_themselves_or_not():
    """Beside 320 trials none of a slow joint's did: 2.2 N m were left where 0.7 can be."""
    regression = halves(Linear(), {"coulomb@a:size": 0.3}, 7).regression
    kinds = [trial.cause.effect for trial in regression.trials]
    usual = ("coulomb", "viscous")
    chosen = PlainSelector(regression).usual(usual)
    labels = [regression.trials[n].cause.label for n in chosen]
    every = {t.cause.label for t in regression.trials if t.cause.effect in usual}
    assert len(labels) == len(set(labels))
    assert set(labels) == every
    other = next(n for n, kind in enumerate(kinds) if kind not in usual)
    beside = PlainSelector(regression).usual(usual, [other, chosen[0]])
    assert {regression.trials[n].cause.label for n in beside} == every | {
        regression.trials[other].cause.label
    }
    assert PlainSelector(regression).usual(("none_such",)) == []
