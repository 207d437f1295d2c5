"""Single steps of the search on a plant that is linear, where each has a closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import SD, Toy, programme

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import NEAR, near, refine
from ves_twin.diagnosis.fit.search import (
    ATTEMPTS,
    CHANCE,
    DAMPING,
    GAIN_RATIO,
    NONLINEAR_CHI2,
    PRIOR_WEIGHT_RATIO,
    SECANT,
    Search,
)
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared

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
    # the toy has no error of integration: the most probable share of its column is none
    assert point.delta == pytest.approx(0.0, abs=1e-3)
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
    assert search.damping == 0.0
    step = search._proposed(point, jacobian, 1.0)
    there = search.at(step.shift, step.delta)
    assert there.chi2 == pytest.approx(step.foretold, rel=1e-3)
    assert there.chi2 < point.chi2
    again = search._proposed(there, jacobian, 1.0)
    assert again.foretold == pytest.approx(there.chi2, rel=1e-3)


def test_a_step_is_the_same_whatever_unit_a_cause_is_counted_in(begun):
    search, point, jacobian = begun
    usual = search._proposed(point, jacobian, 1.0)
    tiny = jacobian.copy()
    tiny[:, 0] *= 1e-6
    search.unit[0] *= 1e-6
    step = search._proposed(point, tiny, 1.0)
    np.testing.assert_allclose(step.shift, usual.shift, rtol=1e-6, atol=1e-9)
    assert step.foretold == pytest.approx(usual.foretold, rel=1e-9)


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


@pytest.fixture
def weights(begun, monkeypatch):
    """Weights of the priors that steps were proposed with."""
    search, asked = begun[0], []
    proposed = search._proposed

    def noted(point, jacobian, weight):
        asked.append(weight)
        return proposed(point, jacobian, weight)

    monkeypatch.setattr(search, "_proposed", noted)
    return asked


def test_the_power_of_causes_is_what_they_take_off_chi2(evidence):
    """Of a linear plant, whose chi^2 is a parabola in their sizes."""
    runs = evidence.runs
    base = linearise(runs, runs.origin)
    ripple = next(h for h in Toy().hypotheses if h.effect == "ripple")
    without = refine(evidence, (), runs.origin, base)
    for causes in ((FRICTION,), (FRICTION, ripple)):
        fit = refine(evidence, causes, runs.origin, base)
        assert fit.power == pytest.approx(without.chi2 - fit.chi2, rel=1e-3)


def test_far_from_noise_a_step_is_tried_at_two_weights_of_the_priors(begun, weights):
    search, point, jacobian = begun
    prior = search._prior_weight(point)
    assert prior > NONLINEAR_CHI2
    there = search._step(point, jacobian)
    assert weights == [prior, PRIOR_WEIGHT_RATIO * prior]
    assert search._prior_weight(there) < NONLINEAR_CHI2
    weights.clear()
    search._step(there, jacobian)
    assert weights[0] == search._prior_weight(there)
    assert PRIOR_WEIGHT_RATIO * weights[0] not in weights


def test_where_no_step_helps_damping_grows_and_the_point_stays(begun, weights, monkeypatch):
    search, point, jacobian = begun
    monkeypatch.setattr(search, "at", lambda *_: replace(point, chi2=np.inf))
    prior = search._prior_weight(point)
    assert search._step(point, jacobian) is point
    assert weights == [prior, PRIOR_WEIGHT_RATIO * prior, *[prior] * (ATTEMPTS - 1)]
    assert search.damping == DAMPING**ATTEMPTS


def test_a_descent_ends_at_noise_with_the_priors_own_weight_untried(begun, monkeypatch):
    search, point, jacobian = begun
    best = search._step(search._step(point, jacobian), jacobian)
    taken, step = [], search._step
    monkeypatch.setattr(search, "_step", lambda *given: taken.append(1) or step(*given))
    found, _ = search.descend(best, jacobian)
    assert found.chi2 == pytest.approx(best.chi2, rel=1e-4)
    assert len(taken) == 1
    assert search.tempered


def test_a_descent_that_stalls_far_from_noise_goes_on_at_the_priors_own_weight(begun, monkeypatch):
    search, point, jacobian = begun
    weights = []

    def stalled(point, jacobian):
        weights.append(search._prior_weight(point))
        return point

    monkeypatch.setattr(search, "_step", stalled)
    assert search.descend(point, jacobian)[0] is point
    assert weights[0] > NONLINEAR_CHI2
    assert weights[1:] == [1.0]


def test_a_small_fall_that_was_foretold_lessens_the_damping(begun):
    search, point, jacobian = begun
    best = search._step(search._step(point, jacobian), jacobian)
    moved = best.shift.copy()
    moved[search.nuisances[0]] += 0.2 * search.runs.sd[search.nuisances[0]]
    beside = search.at(moved, best.delta)
    assert 0.0 < beside.chi2 - best.chi2 < 0.2 * best.chi2
    search.damping, search.tempered = 100.0, False
    search._step(beside, jacobian)
    assert search.damping == 10.0


def test_a_surprise_turns_the_columns_that_may_be_off_before_and_behind_the_whitening(begun):
    """J + (c - J m) (B m)' / (m'B m + CHANCE), B the squares of what the columns may be off by."""
    search, point, jacobian = begun
    whiten = search.evidence.whitening.apply
    off = 1.3 / search.unit[0]  # the column of a whole unit of the cause, too large
    search.raw = np.float32(off) * search.raw
    jacobian[:, 0] *= off
    search.unit[0] = 1.0
    search.bends = np.array([3.0, 2.0, 1.0, 0.0, 0.0])
    before = jacobian.copy()
    shift = point.shift.copy()
    shift[search.free[0]] = 2.0
    shift[search.nuisances[:2]] += search.runs.sd[search.nuisances[:2]]
    trial = search.at(shift, point.delta)
    search._learn(point, trial, jacobian)
    where = np.concatenate([search.free, search.nuisances])
    gap = np.append(trial.shift[where] - point.shift[where], trial.delta - point.delta)
    move = gap / search.unit
    weight = search.bends**2 * move
    surprise = point.residual - trial.residual - before @ move
    expected = before + np.outer(surprise, weight / (weight @ move + CHANCE))
    np.testing.assert_allclose(jacobian, expected, atol=1e-9 * np.abs(expected).max())
    assert np.all(np.abs(jacobian - before).max(axis=0)[:3] > 0.1)
    count = len(search.free)
    for found, columns in (
        (search.raw, jacobian[:, :count]),
        (search.turned[search.kept], jacobian[:, count:-1]),
    ):
        # in single precision, of signals a thousand times the noise
        np.testing.assert_allclose(whiten(found), columns.T, atol=1e-3 * np.abs(columns).max())


@pytest.mark.parametrize(("off", "holds"), [(0.9 * 0.2 * NEAR, True), (1.1 * 0.2 * NEAR, False)])
def test_columns_hold_for_a_cause_within_a_share_of_its_size(search, off, holds):
    shift = search.runs.origin
    shift[search.free[0]] = 1.0
    there = shift.copy()
    there[search.free[0]] = 1.0 - off
    search.local = replace(search.local, point=there)
    assert near(search.local, shift) == holds
    small = 1e-3 * shift
    search.local = replace(search.local, point=1e-3 * there)
    assert near(search.local, small) == holds


@pytest.mark.parametrize(("off", "holds"), [(0.9 * NEAR, True), (1.1 * NEAR, False)])
def test_columns_hold_for_a_nuisance_within_a_share_of_its_sd(search, off, holds):
    shift = search.runs.origin
    shift[search.nuisances[1]] = off * search.runs.sd[search.nuisances[1]]
    assert near(search.local, shift) == holds


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
