"""The multisine: lines of its own for each axis, and the peaks that were asked for."""

import numpy as np

from ves_twin.control.multisine import multisine

PEAK = np.array([0.05, 0.05, 0.02, 0.07, 0.07, 0.1])
PERIOD = 10.0


def made(fade=0.0):
    return multisine(np.zeros(6), PEAK, (0.1, 2.5), PERIOD, fade)


def sampled(motion, start=0.0):
    time = start + np.arange(2000) * PERIOD / 2000
    return np.array([motion.pose(t + 1e-12) for t in time])


def test_every_axis_reaches_its_peak():
    found = np.abs(sampled(made())).max(axis=0)
    np.testing.assert_allclose(found, PEAK, rtol=0.01)  # peaks are found on a grid of 1/50 period


def test_no_line_is_shared_between_axes():
    spectrum = np.abs(np.fft.rfft(sampled(made()), axis=0))
    used = spectrum > 1e-6 * spectrum.max()
    assert used.sum(axis=1).max() == 1
    lines = np.flatnonzero(used.any(axis=1))
    assert lines.min() == 1
    assert lines.max() == 25


def test_all_lines_of_an_axis_have_the_same_speed():
    motion = made()
    speed = motion.amplitude * motion.frequency[:, None]
    for axis in range(6):
        mine = speed[speed[:, axis] > 0, axis]
        np.testing.assert_allclose(mine, mine[0], rtol=1e-12)


def test_it_repeats_after_its_period_and_starts_at_rest():
    motion = made(fade=1.5)
    np.testing.assert_allclose(sampled(motion, 10.0), sampled(motion, 20.0), atol=1e-12)
    assert np.abs(motion.pose(0.01) - motion.pose(0.0)).max() < 1e-6
