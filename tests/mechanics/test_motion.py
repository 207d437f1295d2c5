"""Motions: quintic moves at rest at both ends, sines that fade in."""

import numpy as np
import pytest

from ves_twin.mechanics.joint_motion import ArmMotion, Hold, Move, Sine, quintic

ROUND_OFF = 1e-14
DIFFERENCE = 1e-6
"""Central difference with h = 1e-5: third derivative 60 times h^2 over 6 is 1e-9."""
STEP = 1e-5
TURN = Move(0.5, 2.0, np.array([np.pi, 0.0, 0.0]))


def slope(function, t):
    return (function(t + STEP) - function(t - STEP)) / (2 * STEP)


def test_the_quintic_goes_from_zero_to_one_at_rest():
    assert quintic(0.0) == 0.0
    assert quintic(1.0) == 1.0
    for end in (0.0, 1.0):
        assert abs(slope(quintic, end)) < DIFFERENCE
        curvature = (quintic(end + STEP) - 2 * quintic(end) + quintic(end - STEP)) / STEP**2
        assert abs(curvature) < 1e-2  # the jerk is 60 on one side: 60 h / 2


def test_the_quintic_is_symmetric_and_stays_within_its_ends():
    for s in np.linspace(0.0, 1.0, 51):
        assert abs(quintic(s) + quintic(1.0 - s) - 1.0) < ROUND_OFF
    assert quintic(-3.0) == 0.0
    assert quintic(7.0) == 1.0


def test_the_thesis_move_has_the_fact_sheet_s_peaks():
    """180 deg in 2 s: 2.95 rad/s and 4.53 rad/s^2 (fact sheet 6)."""
    motion = ArmMotion(np.zeros(3), (TURN,))
    time = np.linspace(0.5, 2.5, 20001)
    q1 = np.array([motion.q(t)[0] for t in time])
    rate = np.gradient(q1, time)
    assert abs(np.max(rate) - 2.95) < 0.005
    assert abs(np.max(np.gradient(rate, time)) - 4.53) < 0.01


def test_the_arm_rests_before_between_and_after_its_moves():
    start = np.array([0.1, 0.2, 0.3])
    second = Move(3.0, 1.0, np.array([0.0, 1.0, -1.0]))
    motion = ArmMotion(start, (TURN, second))
    for t, expected in (
        (-1.0, start),
        (0.5, start),
        (2.5, TURN.to),
        (2.9, TURN.to),
        (4.0, second.to),
        (99.0, second.to),
    ):
        np.testing.assert_allclose(motion.q(t), expected, rtol=0, atol=ROUND_OFF)
    np.testing.assert_allclose(motion.q(3.5), (TURN.to + second.to) / 2, rtol=0, atol=ROUND_OFF)


def test_moves_that_touch_make_a_continuous_path():
    motion = ArmMotion(np.zeros(3), (TURN, Move(2.5, 1.0, np.ones(3))))
    before, after = motion.q(2.5 - 1e-9), motion.q(2.5 + 1e-9)
    np.testing.assert_allclose(before, after, rtol=0, atol=1e-12)


@pytest.fixture
def sine():
    return Sine(
        at=np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.2]),
        amplitude=np.array([0.05, 0.04, 0.03, 0.02, 0.01, 0.1]),
        frequency=np.array([0.25, 0.5, 1.0, 2.0, 0.1, 0.4]),
        phase=np.array([0.0, 0.5, 1.0, -1.0, 2.0, 3.0]),
        fade=2.0,
    )


def test_a_sine_starts_at_rest_at_its_middle(sine):
    np.testing.assert_array_equal(sine.pose(-1.0), sine.at)
    np.testing.assert_array_equal(sine.pose(0.0), sine.at)
    np.testing.assert_allclose(slope(sine.pose, 0.0), 0.0, rtol=0, atol=DIFFERENCE)


def test_a_faded_in_sine_has_its_amplitude_and_period(sine):
    time = np.arange(20000) * 1e-3 + 10.0  # whole periods of all six, fade long over
    poses = np.array([sine.pose(t) for t in time])
    np.testing.assert_allclose(poses.mean(axis=0), sine.at, rtol=0, atol=1e-12)
    for k in range(6):
        angle = 2 * np.pi * sine.frequency[k] * time + sine.phase[k]
        in_phase = 2 * np.mean((poses[:, k] - sine.at[k]) * np.sin(angle))
        assert abs(in_phase - sine.amplitude[k]) < 1e-12


def test_without_fading_the_amplitude_is_full_at_once(sine):
    import dataclasses

    sudden = dataclasses.replace(sine, fade=0.0)
    late = sine.pose(2.0 + 1 / 8)
    np.testing.assert_allclose(sudden.pose(2.0 + 1 / 8), late, rtol=0, atol=1e-15)
    assert not np.allclose(sudden.pose(0.1), sine.pose(0.1), atol=1e-4)


def test_hold_stands_still():
    pose = np.arange(6.0)
    assert all(np.array_equal(Hold(pose).pose(t), pose) for t in (-1.0, 0.0, 1e6))
