"""Minimal mass parameters: the printed PUMA form, other chains, and MuJoCo."""

import mujoco
import numpy as np
import pytest

from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.gravity_model import GravityModel, gravity_in_top
from ves_twin.mechanics.kinematics.dh_chain import DhChain, Joint
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.plant.plant import Plant

PUMA = FirstMoments.of(Plant.load("ves2").arm.chain)
ROUND_OFF = 1e-9
"""Sums of products of order 1e3 in double precision, and least squares over well-scaled columns."""

SIX_AXES = DhChain(
    (
        Joint(0.40, 0.18, np.pi / 2),
        Joint(0.0, 0.60, 0.0, theta=np.pi / 2),
        Joint(0.0, 0.12, np.pi / 2),
        Joint(0.62, 0.0, -np.pi / 2),
        Joint(0.0, 0.0, np.pi / 2),
        Joint(0.115, 0.0, 0.0),
    ),
    np.eye(4),
)
WITH_SLIDE = DhChain(
    (Joint(0.3, 0.1, 0.0), Joint(0.0, 0.4, np.pi), Joint(0.05, 0.0, 0.0, prismatic=True)),
    np.eye(4),
)


def printed_moment_matrix(q, g):
    """G of thesis C.2, column by column (facts, section 5)."""
    gx, gy, gz = g
    s1, c1 = np.sin(q[0]), np.cos(q[0])
    columns = [
        [0, -gz, gy], [gz, 0, -gx], [-gy, gx, 0],
        [s1 * gz, -c1 * gz, c1 * gy - s1 * gx],
        [-c1 * gz, -s1 * gz, s1 * gy + c1 * gx],
    ]  # fmt: skip
    for angle in (q[1], q[1] + q[2]):
        s, c = np.sin(angle), np.cos(angle)
        columns.append([s1 * c * gz - s * gy, -c1 * c * gz + s * gx, c1 * c * gy - s1 * c * gx])
        columns.append([-s1 * s * gz - c * gy, c1 * s * gz + c * gx, -c1 * s * gy + s1 * s * gx])
    return np.array(columns).T


def direct_moment(chain, mass, com, q, g):
    """Sum of r x m g over the links (eq. 3.7)."""
    frames = chain.frames(q[None])[0]
    return sum(
        np.cross(m * (frame[:3, :3] @ r + frame[:3, 3]), g)
        for m, r, frame in zip(mass, com, frames, strict=True)
    )


@pytest.mark.parametrize("seed", range(8))
def test_the_puma_has_the_printed_g(seed):
    rng = np.random.default_rng(seed)
    q, g = rng.uniform(-np.pi, np.pi, 3), rng.normal(size=3) * 9.81
    found = PUMA.moment_regressor(q[None], g[None])[0]
    np.testing.assert_allclose(found, printed_moment_matrix(q, g), rtol=0, atol=ROUND_OFF)


def test_the_puma_has_the_printed_p():
    array = Plant.load("ves2").parameters.array
    printed = [0, 0, 63.171, 0, -5.985, 5.066, -0.104, 2.620, 0]  # facts, section 5
    moments = PUMA.parameters(array("arm.mass"), array("arm.com"))
    np.testing.assert_allclose(moments, printed, rtol=0, atol=5.1e-4)  # the last printed digit


def test_nine_of_twelve_parameters_are_left_for_the_puma():
    assert len(PUMA.kept) == 9  # thesis 3.4.4: 3 + 2 per revolute joint


@pytest.mark.parametrize(
    ("chain", "left"), [(SIX_AXES, 3 + 2 * 6), (WITH_SLIDE, None)], ids=["six axes", "slide"]
)
def test_any_chain_predicts_the_moment_of_its_links(chain, left):
    rng = np.random.default_rng(5)
    links = len(chain.joints) + 1
    mass, com = rng.uniform(1.0, 9.0, links), rng.normal(size=(links, 3)) * 0.2
    basis = FirstMoments.of(chain)
    if left is not None:
        assert len(basis.kept) == left  # the rule of eq. 3.9
    for _ in range(20):
        q, g = rng.uniform(-3, 3, links - 1), rng.normal(size=3)
        found = basis.moment_regressor(q[None], g[None])[0] @ basis.parameters(mass, com)
        expected = direct_moment(chain, mass, com, q, g)
        np.testing.assert_allclose(found, expected, rtol=0, atol=ROUND_OFF)


def test_kept_columns_are_independent_and_the_rest_are_not():
    rng = np.random.default_rng(6)
    for basis in (PUMA, FirstMoments.of(SIX_AXES), FirstMoments.of(WITH_SLIDE)):
        q = rng.uniform(-3, 3, (50, len(basis.chain.joints)))
        columns = basis.regressor(q).reshape(150, -1)
        assert np.linalg.matrix_rank(columns) == len(basis.kept)


def test_gravity_in_the_top_frame_is_turned_gravity():
    rng = np.random.default_rng(7)
    angles = rng.uniform(-1.0, 1.0, (30, 3))
    expected = [matrix_from_angles(a).T @ [0.0, 0.0, -9.81] for a in angles]
    np.testing.assert_allclose(gravity_in_top(angles, 9.81), expected, rtol=0, atol=1e-13)


def test_the_model_agrees_with_mujoco():
    """A standing rig: MuJoCo's centre of mass and weight of all that the sensor carries."""
    from ves_twin.plant.assembly import assemble, compile_model
    from ves_twin.plant.layout import Layout
    from ves_twin.plant.statics import place_rig

    plant = Plant.load("ves2")
    model = compile_model(assemble(plant, 341e-6))
    data, layout = mujoco.MjData(model), Layout.of(model)
    rng = np.random.default_rng(8)
    for _ in range(10):
        q, angles = rng.uniform(-2.5, 2.5, 3), rng.uniform(-0.2, 0.2, 3)
        place_rig(data, layout, plant.geometry, np.append(np.zeros(3), angles), q)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        turn = matrix_from_angles(angles)
        arm = turn.T @ (data.subtree_com[layout.sensor_body] - plant.geometry.home)
        force = model.body_subtreemass[layout.sensor_body] * (turn.T @ model.opt.gravity)
        found = plant.gravity_model.wrench_in_top(q[None], angles[None])[0]
        np.testing.assert_allclose(found[:3], force, rtol=0, atol=ROUND_OFF)
        np.testing.assert_allclose(found[3:], np.cross(arm, force), rtol=0, atol=ROUND_OFF)


def test_weight_and_moment_of_the_stretched_level_arm_are_the_printed_ones():
    model: GravityModel = Plant.load("ves2").gravity_model
    wrench = model.wrench_in_top(np.zeros((1, 3)), np.zeros((1, 3)))[0]
    np.testing.assert_allclose(wrench[:3], [0, 0, -919.2], rtol=0, atol=0.05)
    np.testing.assert_allclose(wrench[3:], [-58.7, 75.4, 0.0], rtol=0, atol=0.05)
