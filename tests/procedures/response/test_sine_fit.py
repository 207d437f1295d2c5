"""Fits of sines and of exponentials against signals that are known."""

import numpy as np
import pytest

from ves_twin.procedures.response.sine_fit import MeasuredResponse, fit_sine, measure_response
from ves_twin.procedures.stability.measured_poles import matrix_pencil

TIME = np.arange(3000) * 1.705e-3
HERTZ = 3.3
RNG = np.random.default_rng(7)


def test_a_sine_on_a_ramp_is_found_exactly():
    values = 0.4 * np.cos(2 * np.pi * HERTZ * TIME + 0.7) + 5.0 - 0.3 * TIME
    assert fit_sine(TIME, values, HERTZ) == pytest.approx(0.4 * np.exp(0.7j), abs=1e-9)


def test_the_gain_lies_within_its_standard_error_and_the_error_is_that_of_the_noise():
    """White noise of sd s on n rows: standard error of a fitted amplitude a is s sqrt(2 / n) / a."""
    source = np.sin(2 * np.pi * HERTZ * TIME)
    gain, noise = 0.5 * np.exp(-1.1j), 0.05
    clean = 0.5 * np.sin(2 * np.pi * HERTZ * TIME - 1.1)
    misses, errors = [], []
    for _ in range(200):
        found, error = measure_response(TIME, source, clean + noise * RNG.normal(size=3000), HERTZ)
        misses.append(abs(found / gain - 1.0))
        errors.append(error)
    expected = noise / 0.5 * np.sqrt(2.0 / 3000) * np.sqrt(2.0)  # both parts of the gain
    # 200 trials leave 5 % of scatter, the phases between the parts another few
    assert np.sqrt(np.mean(np.square(misses))) == pytest.approx(expected, rel=0.15)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(expected, rel=0.15)


def test_legs_are_fitted_one_by_one_and_averaged():
    source = np.column_stack([np.sin(2 * np.pi * HERTZ * TIME + p) for p in (0.0, 0.5, 1.0)])
    gain, error = measure_response(TIME, source, source * [0.9, 1.0, 1.1], HERTZ)
    assert gain == pytest.approx(1.0, abs=1e-9)
    assert error < 1e-9


def test_rows_become_a_response():
    response = MeasuredResponse.of([(1.0, 1.0 + 0.0j, 0.01), (2.0, -0.1j, 0.02)])
    np.testing.assert_allclose(response.decibel, [0.0, -20.0], atol=1e-12)
    np.testing.assert_allclose(response.degrees, [0.0, -90.0], atol=1e-12)


def test_the_matrix_pencil_finds_a_slow_and_a_growing_mode():
    poles = np.array([-0.3 + 0.9j, 5.0 + 50.0j])
    time = np.arange(300) / 150.0
    values = np.real(np.exp(poles[0] * time) + 1e-4 * np.exp(poles[1] * time))
    found = matrix_pencil(values, 1 / 150.0, 4)
    for pole in poles:
        assert np.min(np.abs(found - pole)) < 1e-6 * abs(pole)
