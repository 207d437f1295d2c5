"""Ramp: begins and ends where it says, at rest, and no leg is faster than it should be."""

import numpy as np

from ves_twin.control.operation.ramp import Ramp
from ves_twin.plant.plant import Plant

PEAK_OVER_MEAN = 15.0 / 8.0
"""Of a quintic from rest to rest."""


def test_a_ramp_keeps_its_leg_speed_and_its_ends():
    geometry = Plant.load("ves2").geometry
    here, there = np.array([0.05, 0, -0.1, 0, 0.05, 0]), np.array([0, 0.02, 0.1, 0, 0, 0.1])
    ramp = Ramp.between(here, there, 3.0, 0.1, geometry)
    times = np.linspace(3.0, 3.0 + ramp.duration, 2001)
    lengths = np.array([geometry.lengths(ramp.pose(t)) for t in times])
    speed = np.abs(np.diff(lengths, axis=0)) / (times[1] - times[0])
    assert np.array_equal(ramp.pose(3.0), here)
    assert np.array_equal(ramp.pose(3.0 + ramp.duration), there)
    assert not ramp.ended(3.0)
    # legs are not quite linear in the pose: 2 % on this way
    assert np.max(speed) < 1.02 * PEAK_OVER_MEAN * 0.1
    assert np.max(speed[[0, -1]]) < 1e-3 * np.max(speed)


def test_a_ramp_to_where_one_is_takes_no_time():
    ramp = Ramp.between(np.zeros(6), np.zeros(6), 1.0, 0.1, Plant.load("ves2").geometry)
    assert ramp.ended(1.0)
    assert np.array_equal(ramp.pose(1.0), np.zeros(6))
