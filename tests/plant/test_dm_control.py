"""The assembled rig runs under dm_control."""

import os

import mujoco
import numpy as np
import pytest

from ves_twin.plant.statics import place_rig


@pytest.fixture(scope="module")
def physics(rig):
    previous = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disable"  # no renderer is looked for
    try:
        dmm = pytest.importorskip("dm_control.mujoco")
        wrapper = pytest.importorskip("dm_control.mujoco.wrapper")
    finally:
        if previous is None:
            del os.environ["MUJOCO_GL"]
        else:
            os.environ["MUJOCO_GL"] = previous
    return dmm.Physics.from_model(wrapper.MjModel(rig.model))


def test_dm_control_steps_the_rig_as_mujoco_does(rig, physics):
    geometry = rig.plant.geometry
    pose, q = np.array([0.02, 0.01, -0.03, 0.05, -0.04, 0.1]), np.array([0.1, 1.0, 0.5])
    data = mujoco.MjData(rig.model)
    place_rig(data, rig.layout, geometry, pose, q)
    with physics.reset_context():
        physics.data.qpos[:] = data.qpos
    for _ in range(20):
        physics.step()
    mujoco.mj_step(rig.model, data, nstep=20)
    assert physics.data.time == pytest.approx(20 * rig.model.opt.timestep)
    # dm_control splits a step in two halves around the forward pass; the maths is the same
    np.testing.assert_allclose(physics.data.qpos, data.qpos, rtol=0, atol=1e-12)
    assert physics.named.data.xpos["platform/top", "z"] < geometry.home[2] + pose[2]


def test_dm_control_finds_parts_by_their_names(physics):
    assert physics.model.nv == 39
    assert physics.named.model.body_mass["arm/link3"] == 9.0
