"""PathMotion: one smooth sweep along a polyline, without a stop at its corners."""

import numpy as np

from ves_twin.mechanics.joint_motion import ArmMotion, Move, quintic
from ves_twin.mechanics.path_motion import PathMotion

CORNERS = np.array([[0.0, 1.5, 0.0], [0.3, 1.5, 0.4], [1.2, 0.3, 0.4]])
ROUND_OFF = 1e-14
SWEEP = PathMotion(CORNERS, 0.5, 4.0)
LENGTHS = np.linalg.norm(np.diff(CORNERS, axis=0), axis=1)


def test_a_path_of_two_places_is_a_move():
    path = PathMotion(CORNERS[:2], 0.5, 4.0)
    move = ArmMotion(CORNERS[0], (Move(0.5, 4.0, CORNERS[1]),))
    for t in np.linspace(-1.0, 6.0, 57):
        np.testing.assert_allclose(path.q(t), move.q(t), rtol=0, atol=ROUND_OFF)


def test_it_stands_at_both_ends_and_is_at_the_corner_when_its_length_is_covered():
    np.testing.assert_array_equal(SWEEP.q(-1.0), CORNERS[0])
    np.testing.assert_array_equal(SWEEP.q(0.5), CORNERS[0])
    np.testing.assert_allclose(SWEEP.q(9.0), CORNERS[2], rtol=0, atol=ROUND_OFF)
    grid = np.linspace(0.0, 1.0, 100001)
    covered = np.array([quintic(s) for s in grid]) * LENGTHS.sum()
    at_corner = 0.5 + 4.0 * np.interp(LENGTHS[0], covered, grid)
    np.testing.assert_allclose(SWEEP.q(at_corner), CORNERS[1], rtol=0, atol=1e-8)


def test_the_speed_along_the_way_is_that_of_the_quintic_also_at_the_corner():
    h = 1e-4
    times = np.linspace(0.6, 4.4, 400)
    moved = np.array([np.linalg.norm(SWEEP.q(t + h) - SWEEP.q(t)) for t in times]) / h
    s = (times + h / 2 - 0.5) / 4.0
    expected = 30 * s**2 * (1 - s) ** 2 / 4.0 * LENGTHS.sum()
    far = np.abs(moved - expected) > 1e-6  # one step may straddle the corner and cut it
    assert np.count_nonzero(far) <= 1
