"""Static laws: the legs' forces do the work of gravity, reach is checked against travel."""

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import UnreachableError
from ves_twin.plant.statics import check_reach, static_leg_forces, universal_angles

VIRTUAL_WORK = 1e-4
"""N and N m of about 1500: central difference of the potential with h = 1e-4, curvature 500 N/m."""
STEP = 1e-4


def potential(rig, pose, q):
    """Energy of platform and payload against gravity, legs left out."""
    rig.place(pose, q)
    mujoco.mj_kinematics(rig.model, rig.data)
    mujoco.mj_comPos(rig.model, rig.data)
    top = rig.model.body("platform/top").id
    mass = rig.model.body_subtreemass[top]
    return 9.81 * mass * rig.data.subtree_com[top, 2]


def test_leg_forces_do_the_work_of_lifting_platform_and_payload(rig, placements):
    geometry = rig.plant.geometry
    for pose, q in placements[:10]:
        rig.place(pose, q)
        forces = static_leg_forces(rig.model, rig.data, rig.layout, geometry, pose)
        for step in STEP * np.eye(6):
            lifted = potential(rig, pose + step, q) - potential(rig, pose - step, q)
            work = forces @ (geometry.lengths(pose + step) - geometry.lengths(pose - step))
            assert abs(lifted - work) / (2 * STEP) < VIRTUAL_WORK


def test_level_legs_together_carry_the_weight(rig):
    pose, q = np.zeros(6), np.array([np.pi, np.pi / 2, 0.0])
    rig.place(pose, q)
    geometry = rig.plant.geometry
    forces = static_leg_forces(rig.model, rig.data, rig.layout, geometry, pose)
    along = geometry.home + geometry.top - geometry.base
    upward = forces @ (along[:, 2] / np.linalg.norm(along, axis=1))
    assert abs(upward - (60.0 + 93.7) * 9.81) < 1e-9


def test_placing_leaves_the_rig_at_rest_with_straight_legs(rig, placements):
    rig.data.qvel[:] = 1.0
    rig.place(*placements[0])
    assert not rig.data.qvel.any()
    assert not rig.data.qpos[rig.layout.bending_qpos].any()


def test_universal_joints_are_at_zero_at_home(rig):
    np.testing.assert_allclose(
        universal_angles(rig.plant.geometry, np.zeros(6)), 0.0, rtol=0, atol=1e-15
    )


def test_a_pose_within_travel_passes_and_one_outside_names_the_leg(plant):
    geometry = plant.geometry
    change = geometry.lengths(np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])) - geometry.lengths(
        np.zeros(6)
    )
    worst = int(np.argmax(np.abs(change)))
    travel = float(np.abs(change[worst]))
    pose = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    check_reach(geometry, pose, travel + 1e-9, "here")
    with pytest.raises(UnreachableError, match=f"here: .* leg {worst + 1} ") as caught:
        check_reach(geometry, pose, travel - 1e-9, "here")
    assert "\n" not in str(caught.value)


def test_a_pose_that_is_not_a_number_is_out_of_reach(plant):
    with pytest.raises(UnreachableError):
        check_reach(plant.geometry, np.full(6, np.nan), 0.25, "here")
