"""The frame of each leg and what bending does to it."""

import mujoco
import numpy as np

from ves_twin.plant.leg_part import leg_frame

ROUND_OFF = 1e-14
"""Cross products of unit vectors."""


def test_leg_axes_are_a_right_handed_frame_along_the_leg(plant):
    geometry = plant.geometry
    for leg in range(6):
        frame = leg_frame(geometry, leg)
        np.testing.assert_allclose(frame.T @ frame, np.eye(3), rtol=0, atol=ROUND_OFF)
        assert np.linalg.det(frame) > 0.5
        along = geometry.home + geometry.top[leg] - geometry.base[leg]
        np.testing.assert_allclose(
            frame[:, 2] * np.linalg.norm(along), along, rtol=0, atol=ROUND_OFF
        )


def test_the_x_axis_of_a_leg_lies_in_its_vertical_plane_and_points_up(plant):
    for leg in range(6):
        frame = leg_frame(plant.geometry, leg)
        assert abs(frame[2, 1]) < ROUND_OFF  # y is horizontal
        assert frame[2, 0] > 0.0


def test_the_eccentric_hinge_couples_bending_to_the_length(rig):
    """A turn by b about y shortens what stands 5 mm beside the hinge by 5 mm times b."""
    offset = rig.plant.parameters.number("leg.bending_offset")
    small = 1e-6
    data = mujoco.MjData(rig.model)
    model = rig.model
    at = model.joint("leg1/bending_y").qposadr[0]
    ends = []
    for angle in (small, -small):
        data.qpos[:] = model.qpos0
        data.qpos[at] = angle
        mujoco.mj_kinematics(model, data)
        ends.append(data.site("leg1/rod_end").xpos.copy())
    slope = leg_frame(rig.plant.geometry, 0)[:, 2] @ (ends[0] - ends[1]) / (2 * small)
    assert abs(slope - offset) < 1e-8  # central difference of a sine: small^2
