"""The statistics of a comparison against draws whose truth is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from ves_twin.diagnosis.record.residuals.coherence import Companions
from ves_twin.diagnosis.record.residuals.lag import find_lag
from ves_twin.diagnosis.record.residuals.noise import (
    Noise,
    NoiseSource,
    measured_noise,
    noise_of_difference,
)
from ves_twin.diagnosis.record.residuals.spectrum import Power

STEP, ROWS = 0.0126, 1600
WHITE = Noise(1.0, (), 0.0, 1.0, 0.0, NoiseSource.DECLARED)


def coloured(rng, first: float) -> np.ndarray:
    white = rng.standard_normal(ROWS + 200)
    return np.sqrt(1 - first**2) * lfilter([1.0], [1.0, -first], white)[200:]


@pytest.mark.parametrize("first", [0.0, 0.4, -0.3])
def test_noise_of_the_declared_colour_scores_as_noise(first):
    """300 records: scores are never far out, and the mean ratio is one within its own spread."""
    rng = np.random.default_rng(1)
    noise = Noise(1.0, tuple(first**k for k in range(1, 9)), 0.0, 1.0, 0.0, NoiseSource.DECLARED)
    ratios, scores = [], []
    for _ in range(300):
        rms, sigma, z = Power(coloured(rng, first), noise, STEP).band(2.0, 10.0)
        ratios.append(sigma**2)
        scores.append(z)
        assert rms > 0.0
    # 320 independent bins a record: sd of a ratio is 0.07, of the mean of 300 it is 0.004
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.02)
    assert np.max(np.abs(scores)) < 4.0


def test_whiteness_knows_the_colour_of_the_noise_and_its_spread():
    rng = np.random.default_rng(2)
    tinted = Noise(1.0, tuple(0.4**k for k in range(1, 9)), 0.0, 1.0, 0.0, NoiseSource.DECLARED)
    own, foreign = [], []
    for _ in range(300):
        rows = coloured(rng, 0.4)
        lag_one, expected, spread = Power(rows, tinted, STEP).whiteness()
        own.append((lag_one - expected) / spread)
        lag_one, expected, spread = Power(rows, WHITE, STEP).whiteness()
        foreign.append((lag_one - expected) / spread)
    assert np.mean(own) == pytest.approx(0.0, abs=0.3)
    assert 0.7 < np.std(own) < 1.3
    assert min(foreign) > 4.0


def test_a_parseval_sum_of_bands_is_the_variance():
    rows = coloured(np.random.default_rng(3), 0.2)
    power = Power(rows - rows.mean(), WHITE, STEP)
    rms, _, _ = power.band(0.0, 1.01 * 0.5 / STEP)
    assert rms == pytest.approx(rows.std(), rel=0.05)  # a Hann window weighs the middle


@pytest.mark.parametrize("delay", [-0.031, 0.0, 0.0047, 0.02])
def test_a_lag_between_rows_is_found_within_its_sd(delay):
    time = np.arange(ROWS) * STEP
    rng = np.random.default_rng(4)

    def motion(t):
        return np.sin(2 * np.pi * 0.7 * t) + 0.5 * np.sin(2 * np.pi * 1.9 * t + 1.0)

    noisy = motion(time - delay) + 0.05 * rng.standard_normal(ROWS)
    lag = find_lag(noisy, motion(time), STEP)
    assert lag.value == pytest.approx(delay, abs=4.0 * lag.sd + 1e-9)
    # slope rms 5.2 /s: sd = 0.05 / (5.2 sqrt(1600)) = 0.24 ms
    assert lag.sd == pytest.approx(2.4e-4, rel=0.3)


def test_what_looks_later_in_one_part_than_in_another_is_no_lag():
    """Dry friction turns an effort later where a motion is small: by 13 ms in its log, +-0.6."""
    time = np.arange(ROWS) * STEP
    size = 0.2 + 0.8 * time / time[-1]
    motion = size * np.sin(2 * np.pi * 0.7 * time)
    noise = 0.01 * np.random.default_rng(6).standard_normal(ROWS)
    dry = 0.1 * np.sign(np.gradient(motion))
    lag = find_lag(motion + noise, motion, STEP)
    assert abs(lag.value) < 4.0 * lag.sd
    assert find_lag(motion + dry + noise, motion, STEP) is None


def test_lags_of_what_does_not_move_cannot_be_told():
    rng = np.random.default_rng(5)
    assert find_lag(rng.standard_normal(ROWS), rng.standard_normal(ROWS), STEP) is None
    assert find_lag(rng.standard_normal(ROWS), np.zeros(ROWS), STEP) is None


def test_coherence_names_the_column_that_a_residual_follows():
    rng = np.random.default_rng(6)
    drive = np.column_stack([coloured(rng, 0.9) for _ in range(4)])
    companions = Companions(("a", "b", "c", "d"), drive)
    found = companions.of(0.5 * drive[:, 2] + 0.1 * rng.standard_normal(ROWS))
    assert found.column == "c"
    assert found.value > 0.8
    nothing = companions.of(rng.standard_normal(ROWS))
    assert nothing.value < 2.0 * nothing.chance


def test_what_follows_a_rate_is_told_as_that_though_other_columns_share_its_tones():
    """Friction of one joint of an arm, all driven by the same few harmonics of ten seconds."""
    time, rng = np.linspace(0.0, 1.0, ROWS), np.random.default_rng(8)
    tones = np.array([f(2.0 * np.pi * k * time) for k in range(1, 6) for f in (np.sin, np.cos)])
    drive = (rng.standard_normal((4, 10)) / np.repeat(np.arange(1, 6), 2) @ tones).T
    slope = np.gradient(drive[:, 1])
    residual = 3.0 + slope / np.std(slope) + 0.2 * rng.standard_normal(ROWS)
    found = Companions(("a", "b", "c", "d"), drive).of(residual)
    assert found.column == "the rate of b"
    assert found.told
    assert found.value == pytest.approx(1.0 / 1.04, abs=0.02)


def test_a_drift_goes_along_with_no_slow_column():
    """Two slow things are alike to half of their power, whatever they are."""
    time, rng = np.linspace(0.0, 1.0, ROWS), np.random.default_rng(9)
    told = 0
    for _ in range(20):
        walk = np.cumsum(rng.standard_normal((ROWS, 2)), axis=0)
        found = Companions(("a", "b"), walk).of(time + 0.02 * rng.standard_normal(ROWS))
        told += found.told
    assert told <= 2


def test_of_too_few_rows_or_columns_nothing_is_asked():
    assert Companions(("a",), np.zeros((1, 1))).of(np.zeros(1)) is None
    assert Companions((), np.zeros((ROWS, 0))).of(np.zeros(ROWS)) is None


def test_a_standstill_tells_size_and_colour_and_a_silent_column_keeps_the_declared():
    rng = np.random.default_rng(7)
    noise = measured_noise(
        0.3 * coloured(rng, 0.5) + np.linspace(0, 2, ROWS), WHITE, NoiseSource.STILL
    )
    assert noise.source is NoiseSource.STILL
    assert noise.sd == pytest.approx(0.3, rel=0.1)  # 1600 rows of colour 0.5: 2.3 %
    assert noise.colour[0] == pytest.approx(0.5, abs=0.08)
    assert measured_noise(np.full(ROWS, 2.0), WHITE, NoiseSource.STILL) is WHITE


def test_powers_of_two_noises_add_band_by_band_in_a_difference():
    loop = (1.0, 1.0, 1.0, 20.0, 1.0, 1.0, 1.0, 1.0)
    shaking = Noise(1.0, (0.5, 0.2), 0.0, 1.0, 0.0, NoiseSource.STILL, loop)
    quiet = Noise(2.0, (0.1,), 0.0, 1.0, 0.0, NoiseSource.STILL)
    frequency = np.linspace(0.01, 0.49, 400)
    power = {n: n.spectrum(frequency, 1.0) for n in (shaking, quiet)}
    twice = noise_of_difference(shaking, shaking).spectrum(frequency, 1.0)
    np.testing.assert_allclose(twice, 2.0 * power[shaking], rtol=1e-9)
    both = noise_of_difference(quiet, shaking).spectrum(frequency, 1.0)
    # within a band the shape is a mixture, which parts from the sum by an eighth at most here
    np.testing.assert_allclose(both, power[shaking] + power[quiet], rtol=0.125)
