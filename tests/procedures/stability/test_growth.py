"""The growth rate of an oscillation is right on signals and systems whose growth is known."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.procedures.stability.growth import oscillation_growth

PERIOD = 37 * 341e-6
BAND = (5.0, 20.0)
TIME = np.arange(int(30.0 / PERIOD)) * PERIOD
SWING = 100.0 * np.sin(2 * np.pi * 0.11 * TIME) * np.exp(-0.05 * TIME) + 30 * np.cos(TIME)


def oscillation(rate: float, frequency: float = 11.7, start: float = 1.0) -> np.ndarray:
    return start * np.exp(rate * TIME) * np.sin(2 * np.pi * frequency * TIME + 0.3)


@pytest.mark.parametrize("rate", [-0.3, -0.1, 0.05, 0.2, 0.5])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_rate_and_frequency_under_noise_and_a_slow_swing(rate, seed):
    noise = 0.05 * np.random.default_rng(seed).standard_normal(len(TIME))
    growth = oscillation_growth(oscillation(rate) + noise + SWING, PERIOD, BAND)
    # four of its own standard errors, and 2 % where noise is a small part
    assert abs(growth.rate - rate) < 4.0 * growth.sd + 0.02 * abs(rate)
    assert growth.verdict == ("growing" if rate > 0 else "decaying")
    assert growth.frequency == pytest.approx(11.7, abs=0.05)


def test_standard_error_is_honest():
    """Over many draws of the noise the scatter of the rate is what one draw says it is."""
    rates, errors = [], []
    for seed in range(40):
        noise = np.random.default_rng(seed).standard_normal(len(TIME))
        growth = oscillation_growth(oscillation(0.02, start=3.0) + noise, PERIOD, BAND)
        rates.append(growth.rate)
        errors.append(growth.sd)
    # 40 draws know a scatter to 11 %; neighbouring residuals make the error a cautious one
    assert 0.7 < np.median(errors) / np.std(rates) < 2.0


def test_noise_alone_is_undecided():
    verdicts = [
        oscillation_growth(
            SWING + np.random.default_rng(seed).standard_normal(len(TIME)), PERIOD, BAND
        ).verdict
        for seed in range(20)
    ]
    assert set(verdicts) == {"undecided"}


def test_steady_oscillation_is_undecided():
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(TIME))
    assert oscillation_growth(oscillation(0.0) + noise, PERIOD, BAND).verdict == "undecided"


@pytest.mark.parametrize("rate", [-0.15, 0.15])
def test_beat_of_two_modes_does_not_hide_the_growth(rate):
    beat = oscillation(rate, 11.5) + 0.7 * oscillation(rate, 11.8)
    growth = oscillation_growth(beat + SWING, PERIOD, BAND, floor=1e-3)
    assert growth.verdict == ("growing" if rate > 0 else "decaying")
    assert abs(growth.rate - rate) < 3.0 * growth.sd


def test_slow_beat_of_steady_modes_is_not_growth():
    """Half a beat in the record looks like growth and decay; neither is claimed."""
    beat = oscillation(0.0, 11.50) + 0.9 * oscillation(0.0, 11.57)
    assert oscillation_growth(beat, PERIOD, BAND, floor=1e-3).verdict == "undecided"


def test_limit_cycle_has_grown_at_the_rate_of_its_rise():
    """A van der Pol oscillator: growth mu / 2 from small, then a steady amplitude of 2."""
    from scipy.integrate import solve_ivp

    mu, omega = 1.0, 2 * np.pi * 9.0
    solution = solve_ivp(
        lambda t, y: [y[1], mu * (1 - y[0] ** 2) * y[1] - omega**2 * y[0]],
        (0.0, TIME[-1]), [1e-3, 0.0], t_eval=TIME, rtol=1e-8, atol=1e-10,
    )  # fmt: skip
    growth = oscillation_growth(solution.y[0] + SWING, PERIOD, BAND, floor=1e-4)
    assert growth.verdict == "growing"
    # the corner of the fit lies within the last bend, which is a tenth of the rise
    assert growth.rate == pytest.approx(mu / 2, rel=0.1)
    assert growth.amplitude == pytest.approx(np.sqrt(2.0), rel=0.02)


def test_decay_into_counts_is_a_decay():
    signal = np.rint(oscillation(-0.4, start=50.0) / 1.0) * 1.0
    growth = oscillation_growth(signal, PERIOD, BAND)
    assert growth.verdict == "decaying"
    assert growth.rate == pytest.approx(-0.4, abs=0.04)


def test_growth_shorter_than_the_filter_is_refused():
    with pytest.raises(InvalidInputError, match="length of the signal"):
        oscillation_growth(TIME[:100], PERIOD, BAND)
    with pytest.raises(InvalidInputError, match="band"):
        oscillation_growth(TIME, PERIOD, (5.0, 50.0))


@pytest.mark.parametrize("gain", [0.7, 1.3])
def test_rate_of_a_sampled_loop_with_known_poles(gain):
    """x(k+1) = A x(k) with poles r exp(+-i w T): the rate is ln(r) / T."""
    r, angle = np.exp(0.2 * (gain - 1.0) * PERIOD), 2 * np.pi * 8.0 * PERIOD
    x, previous, signal = 1.0, 0.0, []
    for _ in TIME:
        x, previous = 2 * r * np.cos(angle) * x - r * r * previous, x
        signal.append(x)
    growth = oscillation_growth(np.array(signal), PERIOD, BAND, floor=1e-3)
    assert growth.rate == pytest.approx(0.2 * (gain - 1.0), rel=0.02)
    assert growth.frequency == pytest.approx(8.0, abs=0.02)
