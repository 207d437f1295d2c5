"""first_state: where a joint is and how fast it moves at the first row."""

import numpy as np
import pytest

from ves_twin.machines.mjcf.motion.started import first_state

NOISE = 2e-4


@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0])
@pytest.mark.parametrize("corner", [2.0, 5.0, 15.0])
def test_speed_is_known_as_well_as_is_declared_and_not_biased_by_an_acceleration(rate, corner):
    time = np.arange(int(2.0 * rate)) / rate
    clean = 0.3 + 0.2 * time + 0.5 * 3.0 * time**2
    rng = np.random.default_rng(1)
    drawn = clean + NOISE * rng.standard_normal((400, len(time)))
    states = np.array([first_state(row, 1.0 / rate, corner) for row in drawn])
    off = states - np.array([0.3, 0.2])
    declared = np.array([NOISE, 2.0 * np.pi * corner * NOISE])
    # 400 draws tell a mean to a twentieth of the sd, and the sd itself to 4 %
    assert np.all(np.abs(off.mean(axis=0)) < 0.2 * declared)
    assert np.all(off.std(axis=0) < 1.1 * declared)


def test_two_rows_are_enough_for_a_line():
    assert first_state(np.array([1.0, 1.2]), 0.1, 5.0) == pytest.approx((1.0, 2.0))
