"""Every command is held against the legs' travel before it is sent."""

import numpy as np
import pytest

from ves_twin.control.safety import NOT_A_POSE, SAFE, checked_lengths


@pytest.fixture
def check(belief):
    geometry = belief.geometry
    home = geometry.lengths(np.zeros(6))

    def run(pose, travel):
        lengths = np.full(6, 7.0)
        verdict = checked_lengths(
            np.asarray(pose, float),
            geometry.base,
            geometry.top,
            geometry.home,
            home,
            travel,
            lengths,
        )
        return verdict, lengths

    return run


def test_a_safe_command_becomes_leg_lengths(check, belief):
    rng = np.random.default_rng(17)
    for pose in rng.uniform(-1, 1, (20, 6)) * 0.05:
        verdict, lengths = check(pose, 0.242)
        assert verdict == SAFE
        np.testing.assert_array_equal(lengths, belief.geometry.lengths(pose))


def test_the_first_leg_outside_is_named(check, belief):
    """Each leg in turn is the one that a tilt stretches most; its number comes back."""
    home = belief.geometry.lengths(np.zeros(6))
    named = set()
    for heading in np.radians(np.arange(0, 360, 15)):
        pose = np.array([0.0, 0.0, 0.0, 0.2 * np.cos(heading), 0.2 * np.sin(heading), 0.0])
        change = np.abs(belief.geometry.lengths(pose) - home)
        limit = np.sort(change)[-2:].mean()
        assert check(pose, limit)[0] == np.argmax(change) + 1
        assert check(pose, change.max() + 1e-12)[0] == SAFE
        named.add(int(np.argmax(change)) + 1)
    assert len(named) > 3


def test_a_leg_that_is_too_short_is_outside_as_well(check):
    assert check([0.0, 0.0, 0.2, 0.0, 0.0, 0.0], 0.1)[0] > 0
    assert check([0.0, 0.0, -0.2, 0.0, 0.0, 0.0], 0.1)[0] > 0


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_command_that_is_not_finite_is_not_a_pose(check, bad):
    for axis in range(6):
        pose = np.zeros(6)
        pose[axis] = bad
        assert check(pose, 0.242)[0] == NOT_A_POSE


def test_a_command_of_another_length_is_not_a_pose(check):
    assert check(np.zeros(5), 0.242)[0] == NOT_A_POSE
    assert check(np.zeros(7), 0.242)[0] == NOT_A_POSE
