"""Laws that hold anywhere: inversion over the workspace, power, bits that do not depend on pieces."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from ves_twin.core.errors import UnreachableError
from ves_twin.core.signals import SIGNALS
from ves_twin.data.mapping.frames import handedness, rotation_of, turn_signal
from ves_twin.mechanics.kinematics.puma560 import Puma560
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles, rate_matrix
from ves_twin.mechanics.kinematics.wrenches import rotate_wrench, sensor_to_top, top_to_sensor
from ves_twin.plant.plant import Plant

MANY = settings(max_examples=300, deadline=None)

INVERSION = 1e-10
"""m and rad. Newton ends at leg errors of 1e-12 m; the Jacobian's condition is below 100."""
LENGTHS = 1e-9
"""m: what `StewartGeometry.pose` promises of the lengths at its pose."""
TIP = 1e-10
"""m: half the digits are lost in angles of a stretched arm, none in where its tip is."""
ROUND_OFF = 1e-13
"""Share of the largest product in sums of a dozen products of doubles."""
STEP = 1e-6
"""rad: a turn small enough that its square, 1e-12, does not show in a difference."""

PLANT = Plant.load("ves2")
GEOMETRY = PLANT.geometry
HOME = GEOMETRY.lengths(np.zeros(6))
TRAVEL = PLANT.parameters.number("leg.stroke") / 2 - PLANT.parameters.number("leg.margin")
BOX = np.array([0.3, 0.3, 0.3, 0.5, 0.5, 0.6])
"""m and rad: beyond what the legs reach in any direction."""
ARM = Puma560(d0=0.22844, d1=0.672, d2=-0.2435, d3=0.098, a2=0.4318, a3=0.4331)  # thesis B.1


def vectors(size, limit):
    return arrays(np.float64, size, elements=st.floats(-limit, limit))


@st.composite
def reached_poses(draw):
    """A pose that every leg reaches: a point of the box, drawn towards home until it is one."""
    pose = draw(vectors(6, 1.0)) * BOX
    while np.max(np.abs(GEOMETRY.lengths(pose) - HOME)) > TRAVEL:
        pose = 0.9 * pose
    return pose


@MANY
@given(pose=reached_poses())
def test_forward_kinematics_inverts_inverse_kinematics_all_over_the_workspace(pose):
    np.testing.assert_allclose(GEOMETRY.pose(GEOMETRY.lengths(pose)), pose, rtol=0, atol=INVERSION)


@MANY
@given(travel=vectors(6, 1.0), guess=reached_poses())
def test_a_pose_found_has_the_lengths_asked_for_or_none_is_found(travel, guess):
    """Whatever six lengths the legs can have, and wherever the search begins."""
    lengths = HOME + TRAVEL * travel
    try:
        found = GEOMETRY.pose(lengths, guess)
    except UnreachableError:
        return
    np.testing.assert_allclose(GEOMETRY.lengths(found), lengths, rtol=0, atol=LENGTHS)


@MANY
@given(pose=reached_poses(), force=vectors(6, 1e4), twist=vectors(6, 1.0))
def test_legs_do_the_work_that_their_wrench_does_on_the_platform(pose, force, twist):
    """f . dL = (J' f) . twist dt, with dL from lengths of turned and shifted platforms."""
    wrench = GEOMETRY.jacobian(pose).T @ force
    turn = Rotation.from_euler("xyz", pose[3:])
    ends = []
    for sign in (1.0, -1.0):
        turned = Rotation.from_rotvec(sign * STEP * twist[3:]) * turn
        tops = GEOMETRY.home + pose[:3] + sign * STEP * twist[:3]
        ends.append(
            np.linalg.norm(tops + GEOMETRY.top @ turned.as_matrix().T - GEOMETRY.base, axis=1)
        )
    rate = (ends[0] - ends[1]) / (2 * STEP)
    # lengths of 1 m cancel to 1e-16 over a step of 1e-6, for each of six forces
    assert force @ rate == pytest.approx(
        wrench @ twist, rel=0, abs=1e-9 * (1 + np.sum(np.abs(force)))
    )


@MANY
@given(wrench=vectors(6, 3e3), position=vectors(3, 2.0), twist=vectors(6, 10.0))
def test_power_is_the_same_at_the_sensor_and_at_the_top(wrench, position, twist):
    """s is t turned by 180 deg about x, at a position in t: v_s = R (v + w x p), w_s = R w."""
    flip = Rotation.from_euler("x", np.pi).as_matrix()
    velocity, spin = twist[:3], twist[3:]
    at_sensor = np.concatenate([flip @ (velocity + np.cross(spin, position)), flip @ spin])
    size = 1.0 + np.max(np.abs(wrench)) * np.max(np.abs(twist)) * (1.0 + np.max(np.abs(position)))
    power = sensor_to_top(wrench, position) @ twist
    assert power == pytest.approx(wrench @ at_sensor, rel=0, abs=30 * ROUND_OFF * size)
    back = top_to_sensor(sensor_to_top(wrench, position), position)
    np.testing.assert_allclose(back, wrench, rtol=0, atol=30 * ROUND_OFF * (1 + 1e3 * 2.0))


@MANY
@given(angles=vectors(3, np.pi), wrench=vectors(6, 3e3), twist=vectors(6, 10.0))
def test_power_is_the_same_in_turned_axes(angles, wrench, twist):
    r = matrix_from_angles(angles)
    power = rotate_wrench(r, wrench) @ rotate_wrench(r, twist)
    assert power == pytest.approx(wrench @ twist, rel=0, abs=1e-9)  # 12 products of at most 3e4 W


@MANY
@given(angles=vectors(3, 1.5), rates=vectors(3, 1.0))
def test_the_spin_of_the_rates_turns_the_axes_as_the_angles_do(angles, rates):
    """R(t + dt) R(t)' = 1 + dt [w x], w = E rates."""
    ahead, behind = (matrix_from_angles(angles + sign * STEP * rates) for sign in (1, -1))
    turn = (ahead - behind) / (2 * STEP) @ matrix_from_angles(angles).T
    spin = np.array([turn[2, 1], turn[0, 2], turn[1, 0]])
    # round-off 1e-16 over a step of 1e-6
    np.testing.assert_allclose(rate_matrix(angles) @ rates, spin, rtol=0, atol=1e-9)


SIGNED = st.permutations(["x", "y", "z"]).flatmap(
    lambda axes: st.tuples(*(st.sampled_from([axis, f"-{axis}"]) for axis in axes))
)


@MANY
@given(axes=SIGNED, origin=vectors(3, 2.0), wrench=vectors(6, 3e3), twist=vectors(6, 10.0))
def test_an_imported_wrench_keeps_its_power(axes, origin, wrench, twist):
    """Recorded about another point in other axes: v_r = R' (v + w x r), w_r = R' w."""
    assume(handedness(axes) == 1)
    r = rotation_of(axes)
    found = turn_signal(wrench[None, :], SIGNALS["sensor.wrench"], axes, origin)[0]
    velocity, spin = twist[:3], twist[3:]
    recorded = np.concatenate([r.T @ (velocity + np.cross(spin, origin)), r.T @ spin])
    size = 1.0 + np.max(np.abs(wrench)) * np.max(np.abs(twist)) * (1.0 + np.max(np.abs(origin)))
    assert found @ twist == pytest.approx(wrench @ recorded, rel=0, abs=30 * ROUND_OFF * size)


@MANY
@given(q=vectors(3, np.pi), elbow=st.sampled_from([-1, 1]), shoulder=st.sampled_from([-1, 1]))
def test_the_arm_brings_its_tip_back_to_wherever_it_has_been(q, elbow, shoulder):
    tip = ARM.tip(q)
    np.testing.assert_allclose(ARM.tip(ARM.inverse(tip, elbow, shoulder)), tip, rtol=0, atol=TIP)


@pytest.mark.parametrize("turn", [0.0, 90.0, 180.0, -37.0])
@pytest.mark.parametrize("rise", [90.0, -90.0])
def test_an_arm_above_or_below_its_shoulder_is_within_reach(turn, rise):
    """There the tip is as near to the axis of joint 1 as it can be, PUMA's own home among them."""
    tip = ARM.tip(np.radians([turn, rise, 0.0]))
    np.testing.assert_allclose(ARM.tip(ARM.inverse(tip)), tip, rtol=0, atol=TIP)
