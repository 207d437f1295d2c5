"""Modes of the sensor's slow noise."""

import numpy as np
import pytest

from ves_twin.machines.ves2.slow_noise import MODES, slow_modes

TIME = np.linspace(0.0, 10.0, 800)


def test_the_modes_hold_nearly_all_of_a_random_walk_from_zero():
    """T far above the record: x(t) - x(-t0) is a random walk of variance 2 (t + t0) / T."""
    long = 2000.0
    variance = np.sum(slow_modes(TIME, long, zeroed=0.5) ** 2, axis=1)
    expected = 2.0 * (TIME + 0.5) / long
    # 7 modes of a Brownian path leave 2 / (pi^2 7) = 3 % of its mean variance
    assert np.mean(variance) == pytest.approx(np.mean(expected), rel=0.04)


def test_simulated_noise_has_unit_weights():
    """Gauss-Markov paths by recursion, projected on the modes."""
    rng, t0, decay = np.random.default_rng(0), 40, np.exp(-0.0125 / 20.0)
    steps = rng.standard_normal((400, 840)) * np.sqrt(1.0 - decay**2)
    paths = np.empty_like(steps)
    paths[:, 0] = rng.standard_normal(400)
    for k in range(1, 840):
        paths[:, k] = decay * paths[:, k - 1] + steps[:, k]
    rows = paths[:, t0:] - paths[:, :1]
    modes = slow_modes(0.0125 * np.arange(800), 20.0, zeroed=0.5)
    weights = rows @ modes / np.sum(modes**2, axis=0)
    # 400 paths: the sd of an sd is 3.5 %
    assert np.std(weights, axis=0) == pytest.approx(np.ones(MODES), abs=0.15)
    assert np.abs(np.mean(weights, axis=0)).max() < 0.2
