"""The gain on held-out recordings against dense matrices of a linear-Gaussian plant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import NUISANCES, QUICK, SD, Toy, programme, shape

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out import HeldOut
from ves_twin.diagnosis.unseen.held_out_gain import (
    BLOCK_SECONDS,
    DivergedError,
    _starts,
    _stretches,
    held_out_gain,
)
from ves_twin.report.diagnosis.basis import rms_words

TRUE = {"plant.gain": 1.03, "plant.slope": 0.04, "friction.size": 0.06}
SINGLE = 1e-3
"""Relative: predictions in single precision against signals 100 times the noise."""


def noisy(fed, values, seed):
    rows = Toy().simulate(fed, values)
    noise = np.random.default_rng(seed).standard_normal(rows.shape) * SD
    return (rows + noise).astype(np.float32)


@pytest.fixture(scope="module")
def fitted():
    """Fits of commissioning errors alone and of friction to a first recording."""
    first = programme(1)
    runs = Runs(Toy(), (first,), (0, 1))
    measured = noisy(first, TRUE | {"plant.offset": 0.06}, 1)
    evidence = Evidence(runs, measured, whitening_declared(runs))
    local = linearise(runs, runs.origin)
    friction = next(h for h in Toy().hypotheses if h.effect == "friction")
    return refine(evidence, (), runs.origin, local), refine(
        evidence, (friction,), runs.origin, local
    )


@pytest.fixture(scope="module")
def held_out(fitted):
    """Another recording of the same rig, its offset another, and the gain there."""
    fed = programme(2)
    runs = Runs(Toy(), (fed,), (0, 1))
    measured = noisy(fed, TRUE | {"plant.offset": -0.03}, 2)
    whitening = whitening_declared(runs)
    return fed, runs, measured, whitening, held_out_gain(runs, measured, whitening, *fitted)


class Dense:
    """A fit carried to a recording: mean, columns and covariance, each written out."""

    def __init__(self, fit, fed, runs, without=()):
        there = fit.local.runs
        names = [there.coordinates[i].parameter.name for i in fit.active]
        shared = [k for k, name in enumerate(names) if name != "plant.offset"]
        u, time = fed.drive["drive.u"][:, 0], fed.time
        shapes = {
            "plant.gain": u[:, None] * [0.3, 1.0],
            "plant.slope": np.gradient(u, time)[:, None] * [0.05, 0.2],
            "plant.offset": np.ones((len(u), 2)) * [1.0, 0.3],
            "friction.size": shape("friction", u, time),
        }
        shifts = {names[k]: fit.shift[fit.active[k]] for k in shared if names[k] not in without}
        values = {"plant.gain": 1.0}
        for name, shift in shifts.items():
            values[name] = values.get(name, 0.0) + shift
        self.mean = Toy().simulate(fed, values)
        self.columns = np.array([*(shapes[names[k]] for k in shared), shapes["plant.offset"]])
        self.prior = np.zeros((len(shared) + 1, len(shared) + 1))
        self.prior[:-1, :-1] = fit.posterior[np.ix_(shared, shared)]
        self.prior[-1, -1] = NUISANCES[2].sd ** 2

    def left(self, measured, whitening):
        z = whitening.apply((measured - self.mean).astype(np.float32))
        white = whitening.apply(self.columns.astype(np.float32)).T
        return z, np.linalg.solve(np.eye(len(z)) + white @ self.prior @ white.T, z)

    def mean_square(self, measured, whitening):
        z, left = self.left(measured, whitening)
        return z @ left / len(z)


def test_means_are_chi2_with_the_carried_covariance(fitted, held_out):
    fed, runs, measured, whitening, gain = held_out
    nominal, extended = fitted
    after = Dense(extended, fed, runs)
    own = whitening.adapted(after.left(measured, whitening)[1])
    before = Dense(nominal, fed, runs)
    taken_out = Dense(extended, fed, runs, without=("friction.size",))
    assert gain.after == pytest.approx(after.mean_square(measured, own), rel=SINGLE)
    assert gain.before == pytest.approx(before.mean_square(measured, own), rel=SINGLE)
    assert gain.without == pytest.approx(taken_out.mean_square(measured, own), rel=SINGLE)
    # declared noise is the noise, so the floor is 1
    assert gain.share == pytest.approx((gain.before - gain.after) / (gain.before - 1.0), rel=SINGLE)


def test_a_cause_without_numbers_is_carried_over_as_it_is(fitted, held_out):
    """As a sensor that holds its rows: nothing of it can be taken out again."""
    _, runs, measured, whitening, gain = held_out
    nominal, extended = fitted
    (friction,) = extended.causes
    hold = replace(friction, effect="hold", parameters=())
    with_hold = replace(extended, causes=(friction, hold))
    assert held_out_gain(runs, measured, whitening, nominal, with_hold) == gain


def test_errors_are_rms_of_what_the_carried_means_leave(fitted, held_out):
    fed, runs, measured, _, gain = held_out
    means = [Dense(fit, fed, runs).mean for fit in fitted]
    for c, name in enumerate(("out.0", "out.1")):
        expected = [np.sqrt(np.mean((measured - mean)[:, c] ** 2)) for mean in means]
        assert gain.errors[name] == pytest.approx(expected, rel=SINGLE)


def test_a_gain_by_the_true_cause_passes_and_its_interval_holds_it(held_out):
    gain = held_out[-1]
    assert gain.passed
    assert gain.carries_on
    assert gain.low < gain.share < gain.high
    assert gain.low > 0.8
    assert gain.high < 1.1


def test_the_interval_is_of_its_confidence_and_of_its_draws(fitted, held_out):
    _, runs, measured, whitening, gain = held_out
    half = held_out_gain(runs, measured, whitening, *fitted, confidence=0.5)
    assert gain.low < half.low < half.high < gain.high
    # 5 to 95 % and 25 to 75 % of a normal: 1.645 and 0.674 sd
    assert (gain.high - gain.low) / (half.high - half.low) == pytest.approx(2.44, rel=0.15)
    assert held_out_gain(runs, measured, whitening, *fitted, seed=0) == gain  # it repeats itself
    other = held_out_gain(runs, measured, whitening, *fitted, seed=1)
    assert other.low != gain.low
    # quantiles of 2000 draws
    assert other.low == pytest.approx(gain.low, abs=0.1 * (gain.high - gain.low))


def test_where_the_effect_does_not_show_there_is_no_share(fitted):
    still = programme(3, amplitude=0.0)
    runs = Runs(Toy(), (still,), (0, 1))
    measured = noisy(still, TRUE | {"plant.offset": 0.02}, 3)
    gain = held_out_gain(runs, measured, whitening_declared(runs), *fitted)
    assert (gain.share, gain.low, gain.high) == (None, None, None)
    assert not gain.passed
    assert gain.before == pytest.approx(gain.after, abs=0.01)
    # four sd of a mean of 1600 squares
    assert gain.before == pytest.approx(1.0, abs=0.15)


PASSING = Gain(0.5, 0.4, 0.6, 4.0, 2.0, {"out": (1.0, 0.5)}, 3.0)


@pytest.mark.parametrize(
    ("changed", "passed", "carries_on"),
    [
        ({}, True, True),
        ({"low": 0.0}, False, False),
        ({"low": None}, False, False),
        ({"low": 1e-6}, True, True),
        ({"without": None}, True, True),
        ({"without": 2.0}, False, False),
        ({"without": 2.1}, True, True),
        ({"errors": {"out": (1.0, 1.24)}}, True, True),
        ({"errors": {"out": (1.0, 1.26)}}, False, False),
        ({"errors": {"out": (1.0, 1.51)}}, False, False),
        ({"errors": {"a": (1.0, 1.51), "b": (1.0, 0.67)}}, False, False),
        ({"errors": {"a": (1.0, 1.51), "b": (1.0, 0.66)}}, True, False),
        ({"errors": {"a": (1.0, 1.51), "b": (0.0, 0.0)}}, False, False),
        ({"errors": {"a": (1.0, 2.0), "b": (1.0, 0.1)}}, True, False),
        ({"errors": {}}, True, True),
    ],
)
def test_what_a_gain_must_show(changed, passed, carries_on):
    gain = replace(PASSING, **changed)
    assert (gain.passed, gain.carries_on) == (passed, carries_on)


def test_errors_count_over_the_model_as_given_where_its_tuning_predicts_worse():
    """A crane: 0.18 m as given, 0.54 m tuned, 0.077 m with a friction; the sway grew by a tenth."""
    errors = {"rail": (0.544, 0.0765), "sway": (0.107, 0.0855)}
    gain = replace(PASSING, errors=errors, given={"rail": 0.181, "sway": 0.0774})
    assert gain.over == {"rail": (0.181, 0.0765), "sway": (0.0774, 0.0855)}
    better = replace(gain, given={"rail": 0.6, "sway": 0.2})
    assert better.over == replace(gain, given={}).over == errors
    assert replace(gain, given={"rail": np.nan, "sway": 0.1}).over == errors
    assert replace(gain, given={"rail": 0.1}).over == errors
    words = rms_words(gain)
    assert "falls by 58 % (rail)" in words
    assert "grows by 10 % (sway), over the model as given" in words
    assert not gain.fallen
    assert gain.worse == ("sway",)


def test_a_model_that_is_worse_than_the_one_that_was_given_does_not_pass():
    worse = replace(PASSING, errors={"out": (3.0, 1.3)}, given={"out": 1.0})
    assert not worse.passed
    assert replace(worse, given={}).passed


def test_columns_that_are_known_at_nominal_serve_where_they_do_not_bend(fitted, held_out):
    _, runs, measured, whitening, gain = held_out
    known = held_out_gain(runs, measured, whitening, *fitted, base=linearise(runs, runs.origin))
    for name in ("share", "low", "high", "before", "after", "without"):
        assert getattr(known, name) == pytest.approx(getattr(gain, name), rel=2.0 * SINGLE)


def test_stretches_hold_every_sample_once_and_none_is_short(held_out):
    _, runs, _, whitening, _ = held_out
    stride = round(BLOCK_SECONDS / runs.grids[0].step)
    for rows in (stride // 4, stride, 3 * stride + stride // 4, 3 * stride + 3 * stride // 4):
        lengths = np.diff([*_starts(runs, 0, rows), rows])
        assert lengths.sum() == rows
        assert np.all(lengths[:-1] == stride)
        assert lengths[-1] <= 1.5 * stride
        assert lengths[-1] >= min(rows, stride // 2)
    assert _stretches(runs, whitening).sum() == len(whitening.freedom)


@pytest.mark.parametrize(
    ("changed", "unconfirmed"),
    [
        ({}, False),
        ({"low": -0.1}, True),
        ({"share": None, "low": None}, False),
        ({"share": None, "low": None, "after": 4.1}, True),
        ({"share": None, "low": None, "after": 4.0}, False),
    ],
)
def test_what_speaks_against_the_causes(changed, unconfirmed):
    assert replace(PASSING, **changed).unconfirmed == unconfirmed


class Turning(Toy):
    """Its slope turns the response from one channel to the other, by 0.25 rad for one sd."""

    def simulate(self, programme, values, refined=False):
        turn = 5.0 * values.get("plant.slope", 0.0)
        u = programme.drive["drive.u"]
        rows = super().simulate(programme, {**values, "plant.slope": 0.0})
        return rows + 3.0 * u * [np.sin(turn), np.cos(turn)]


def test_the_model_before_is_far_off_by_whichever_columns():
    known = replace(NUISANCES[0], sd=0.0)
    plant = Turning(nuisances=(known, *NUISANCES[1:]))
    first, second = programme(1), programme(2)
    runs, there = (Runs(plant, (fed,), (0, 1)) for fed in (first, second))
    rng = np.random.default_rng(5)
    rows, other = (
        (plant.simulate(fed, {"plant.slope": slope}) + rng.standard_normal((800, 2)) * SD).astype(
            np.float32
        )
        for fed, slope in ((first, 0.12), (second, 0.12))
    )
    local = linearise(runs, runs.origin)
    evidence = Evidence(runs, rows, whitening_declared(runs))
    own = refine(evidence, (), runs.origin, local, rounds=3)
    at_zero = replace(own, shift=np.zeros_like(own.shift))
    whitening = whitening_declared(there)
    gain = held_out_gain(there, other, whitening, at_zero, own)
    swapped = held_out_gain(there, other, whitening, own, at_zero)
    assert gain.after == pytest.approx(1.0, abs=0.15)
    # the same two models, whichever is the extended one, but for the noise each is judged by
    assert swapped.after > 100.0
    assert gain.before > 100.0


def test_a_fit_whose_plant_diverges_on_held_out_rows_has_no_gain(fitted, held_out):
    """Ended early, a fit lies where pieces of a floating robot diverge: no number is there."""
    _, runs, measured, whitening, _ = held_out
    nominal, extended = fitted

    class Failing(Toy):
        def simulate(self, programme, values, refined=False):
            rows = super().simulate(programme, values, refined)
            return rows if not values["friction.size"] else np.nan * rows

    runs = replace(runs, forward=Failing())
    with pytest.raises(DivergedError):
        held_out_gain(runs, measured, whitening, nominal, extended)
    held = HeldOut(Dataset(runs, measured, ()), whitening, QUICK)
    assert held.gain(nominal, extended) is None
    assert held.gain(nominal, nominal) is not None


def test_a_gain_over_a_channel_that_tolerances_bent_away_is_none_whatever_the_others_do():
    """A servo: its position 25 mrad as given, 38 tuned, 28 with a cause that *took 25 % away*."""
    errors = {"place": (0.0376, 0.0283), "speed": (0.21, 0.20)}
    gain = replace(PASSING, errors=errors, given={"place": 0.0249, "speed": 0.25})
    assert gain.over == {"place": (0.0249, 0.0283), "speed": (0.21, 0.20)}
    assert gain.worse == ("place",)


def test_where_all_channels_together_were_bent_away_the_better_of_both_counts_in_each():
    errors = {"a": (0.1, 0.15), "b": (1.0, 0.08)}
    gain = replace(PASSING, errors=errors, given={"a": 0.2, "b": 0.1})
    assert gain.over == {"a": (0.1, 0.15), "b": (0.1, 0.08)}


def test_a_gain_is_told_over_the_better_of_the_model_as_given_and_as_tuned():
    """Two arms: 1.65 N m as given, 1.8 tuned, 1.29 extended, and *falls by 28 %* was said."""
    gain = replace(PASSING, errors={"arm": (1.8, 1.29)}, given={"arm": 1.65})
    assert gain.over == gain.errors
    assert "falls by 22 % (arm), over the model as given" in rms_words(gain)
    nearer = replace(gain, given={"arm": 2.0})
    assert "falls by 28 % (arm), over what the model leaves with its tolerances" in rms_words(
        nearer
    )
    assert rms_words(replace(gain, given={"arm": 1.8})).endswith("falls by 28 % (arm)")
