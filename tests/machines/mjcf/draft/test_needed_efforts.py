"""Efforts along a recorded motion are those of MuJoCo's inverse dynamics, row by row."""

from __future__ import annotations

import mujoco
import numpy as np
from three_joints import ARM, moved

from ves_twin.machines.mjcf.draft.motion import motion_of
from ves_twin.machines.mjcf.motion.smoothed import smoothed

PERIOD, CORNER = 0.005, 4.0


def test_what_speeds_and_weight_need_is_what_a_motion_without_accelerations_needs():
    model = mujoco.MjModel.from_xml_string(ARM)
    _, q, _, _ = moved(model, 2)
    smooth = np.array([smoothed(row, PERIOD, CORNER) for row in q]).T
    moving = dict(zip(("turn", "lift", "bend"), smooth.T, strict=True))
    found = motion_of(model, moving, PERIOD, CORNER)
    pull = np.gradient(np.gradient(smooth, PERIOD, axis=0), PERIOD, axis=0)[found.rows]
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    for k in range(0, len(found.rows), 97):
        for share, efforts in ((1.0, found.effort), (0.0, found.steady)):
            data = mujoco.MjData(model)
            data.qpos[:] = smooth[found.rows[k]]
            data.qvel[:], data.qacc[:] = found.speed[k], share * pull[k]
            mujoco.mj_inverse(model, data)
            np.testing.assert_array_equal(efforts[k], data.qfrc_inverse)
