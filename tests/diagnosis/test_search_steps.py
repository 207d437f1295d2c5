"""Single steps of the search on a plant that is linear, where each has a closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import SD, Toy, programme

from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.refine import refine
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.search import DAMPING, GAIN_RATIO, SECANT, Search
from ves_twin.diagnosis.whitening import whitening_declared

FED = programme(1)
FRICTION = next(h for h in Toy().hypotheses if h.effect == "friction")
TRUE = {"friction.size": 0.05, "plant.slope": 0.06, "plant.gain": 1.03}


@pytest.fixture(scope="module")
def evidence():
    runs = Runs(Toy(), (FED,), (0, 1))
    clean = Toy().simulate(FED, TRUE)
    noise = np.random.default_rng(2).standard_normal(clean.shape) * SD
    return Evidence(runs, (clean + noise).astype(np.float32), whitening_declared(runs))


@pytest.fixture
def search(evidence):
    runs = evidence.runs
    made = Search(evidence, runs.indices(FRICTION), linearise(runs, runs.origin))
    made.tempered = True
    return made


@pytest.fixture
def begun(search):
    point = search.at(search.runs.origin, 0.0)
    return search, point, search.jacobian(point)


def test_a_point_has_chi2_of_its_residual_and_of_the_priors(search):
    runs = search.runs
    shift = runs.origin
    shift[runs.nuisances] += 1.5 * runs.sd[runs.nuisances]
    point = search.at(shift, 0.5)
    errors = point.shift[runs.nuisances] / runs.sd[runs.nuisances]
    residual = search.evidence.whitening.apply(search.evidence.measured - runs.one(point.shift))
    assert point.chi2 == pytest.approx(
        residual @ residual + errors @ errors + point.delta**2, rel=1e-4
    )


class Fragile(Toy):
    """It fails beyond a slope: there are no channels there."""

    def simulate(self, programme, values, refined=False):
        rows = super().simulate(programme, values, refined)
        return np.full_like(rows, np.nan) if values.get("plant.slope", 0.0) > 0.02 else rows


def test_a_point_where_the_plant_fails_is_infinitely_bad(evidence):
    runs = Runs(Fragile(), (FED,), (0, 1))
    made = Search(
        replace(evidence, runs=runs), runs.indices(FRICTION), linearise(runs, runs.origin)
    )
    shift = runs.origin
    shift[runs.nuisances] += runs.sd[runs.nuisances]
    point = made.at(shift, 0.25)
    assert point.chi2 == np.inf
    assert point.delta == 0.25
    assert np.array_equal(point.shift, shift)
    found, jacobian = made.run(point)
    assert found is point
    assert jacobian.shape == (0, len(made.unit))


def test_priors_weigh_nuisances_and_the_step_but_no_cause(begun):
    search, _, jacobian = begun
    plain = jacobian.T @ jacobian
    added = search.hessian(jacobian, 7.0) - plain
    np.testing.assert_allclose(added, np.diag([0.0, *[7.0] * (len(plain) - 1)]), atol=1e-6)
    np.testing.assert_allclose(np.diag(search.hessian(jacobian) - plain)[1:], 1.0, rtol=1e-6)


def test_the_column_of_a_cause_is_a_difference_over_its_own_ends(begun):
    search, point, jacobian = begun
    axis = int(search.free[0])
    ends = search._ends(point.shift, axis)
    slope = (search.runs.one(ends[1]) - search.runs.one(ends[0])) / (ends[1][axis] - ends[0][axis])
    expected = search.evidence.whitening.apply(slope.astype(np.float32))
    np.testing.assert_allclose(jacobian[:, 0] / search.unit[0], expected, rtol=2e-3, atol=0.5)


@pytest.mark.parametrize(
    ("size", "reach"), [(2.0, SECANT * 2.0), (-2.0, SECANT * 2.0), (0.0, 1e-4)]
)
def test_the_ends_lie_a_share_of_the_size_to_either_side(search, size, reach):
    axis = int(search.free[0])
    shift = search.runs.origin
    shift[axis] = size
    below, above = search._ends(shift, axis)
    # without a size and an sd: 1e-5 of the range, which is 10
    assert (size - below[axis], above[axis] - size) == pytest.approx((reach, reach))
    others = np.delete(np.arange(len(shift)), axis)
    assert np.array_equal(below[others], shift[others])
    assert np.array_equal(above[others], shift[others])


def test_the_ends_stay_within_bounds(search):
    axis = int(search.free[0])
    shift = search.runs.origin
    shift[axis] = search.high[axis]
    below, above = search._ends(shift, axis)
    assert above[axis] == search.high[axis]
    assert below[axis] == pytest.approx((1.0 - SECANT) * search.high[axis])


def test_an_undamped_step_of_a_linear_plant_is_the_whole_way(begun):
    search, point, jacobian = begun
    step = search._proposed(point, jacobian, 1.0)
    there = search.at(step.shift, step.delta)
    assert there.chi2 == pytest.approx(step.foretold, rel=1e-3)
    assert there.chi2 < point.chi2
    again = search._proposed(there, jacobian, 1.0)
    assert again.foretold == pytest.approx(there.chi2, rel=1e-3)


def test_damping_shortens_the_nuisances_way(begun):
    search, point, jacobian = begun
    free = search._proposed(point, jacobian, 1.0)
    search.damping = 1e9
    held = search._proposed(point, jacobian, 1.0)
    moved = np.abs(held.shift - point.shift)[search.nuisances] / search.runs.sd[search.nuisances]
    assert np.all(moved < 1e-2)
    assert held.foretold > free.foretold
    # the cause has no prior and no damping
    assert held.shift[search.free[0]] != point.shift[search.free[0]]


@pytest.mark.parametrize(
    ("damping", "fall", "hoped", "then"),
    [
        (1000.0, 1.0, 1.0, 1000.0 / DAMPING),
        (DAMPING, 1.0, 1.0, 0.0),
        (1000.0, 1.01 * GAIN_RATIO, 1.0, 1000.0 / DAMPING),
        (1000.0, 0.99 * GAIN_RATIO, 1.0, 1000.0),
    ],
)
def test_damping_falls_where_a_step_does_what_was_foretold(search, damping, fall, hoped, then):
    search.damping = damping
    search._trust(fall, hoped)
    assert search.damping == then


def test_the_prior_weight_is_the_squared_residual_a_sample_while_tempered(begun):
    search, point, _ = begun
    assert search._prior_weight(point) == pytest.approx(
        point.residual @ point.residual / len(point.residual)
    )
    assert search._prior_weight(point) > 1.0
    search.tempered = False
    assert search._prior_weight(point) == 1.0


def test_a_fit_knows_how_its_parameters_hang_together(evidence):
    runs = evidence.runs
    fit = refine(evidence, (FRICTION,), runs.origin, linearise(runs, runs.origin))
    names = [runs.coordinates[i].parameter.name for i in fit.active]
    assert names[0] == "friction.size"
    columns = []
    for i in fit.active:
        move = runs.origin
        move[i] = 0.01
        change = (runs.one(move) - runs.one(runs.origin)) / np.float32(0.01)
        columns.append(evidence.whitening.apply(change))
    white = np.array(columns)
    prior = np.array([0.0, *(1.0 / runs.sd[i] ** 2 for i in fit.active[1:])])
    expected = np.linalg.inv(white @ white.T + np.diag(prior))
    sd = np.sqrt(np.diag(expected))
    found = fit.posterior / np.outer(sd, sd)
    # correlations; predictions are in single precision
    np.testing.assert_allclose(found, expected / np.outer(sd, sd), atol=5e-3)
    assert np.max(np.abs(found - np.diag(np.diag(found)))) > 0.1
    pulls = np.abs(fit.shift[fit.active[1:]]) / runs.sd[fit.active[1:]]
    assert fit.pull == pytest.approx(np.max(pulls))


def test_a_search_ends_where_its_falls_do_not_come_down_to_what_counts(search, monkeypatch):
    begin = search.at(search.runs.origin, 0.0)

    def steps(target):
        taken = []

        def fall(point, jacobian):
            taken.append(point.chi2)
            return replace(point, chi2=900.0 + 0.8 * (point.chi2 - 900.0))

        monkeypatch.setattr(search, "_step", fall)
        search.target = target
        end, _ = search.descend(replace(begin, chi2=1900.0), np.zeros((0, 0)))
        return len(taken), end.chi2

    search.tempered = False
    every, best = steps(np.inf)
    assert steps(900.0) == (every, best)  # at the pace of the falls it would be reached
    # ten times the first fall, of 200, reach from 1700 down to -300
    assert steps(-600.0)[0] == 1
    assert 1 < steps(0.0)[0] < every
