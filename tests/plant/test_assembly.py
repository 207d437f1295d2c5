"""The assembled rig: its size, its numbers against the files, its loop, its sensor."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ves_twin.plant.assembly import assemble
from ves_twin.plant.plant import mjcf_part
from ves_twin.plant.statics import place_rig

CLOSURE = 1e-12
"""m. Rod end and platform joint come out of different chains of double-precision products."""
STATIC = 1e-9
"""Relative to the weight and its moment: no dynamics enters, only round-off of sums."""
SAME_NUMBER = 1e-12
"""The XML and the TOML hold the same decimal numbers."""
WRITTEN_DIGITS = 5e-5
"""m. leg.xml writes its home length with four digits; the assembly computes it."""

# Appendix B, typed again: masses, P and total of the fact sheet, section 5.
MASS = [54.5, 12.8, 17.4, 9.0]
COM = [[0.0, 0.0, 0.283], [0.0, 0.0, -0.056], [-0.364, -0.006, 0.016], [-0.142, 0.0, 0.0]]
D0, D1, D2, D3, A2, A3 = 0.22844, 0.672, -0.2435, 0.098, 0.4318, 0.4331
SENSOR = np.array([-0.001, -0.00066, 0.18944])
GRAVITY = 9.81


def first_moments():
    """P of the fact sheet, kg m."""
    m0, m1, m2, m3 = MASS
    r0, r1, r2, r3 = COM
    return np.array(
        [
            m0 * r0[0],
            m0 * r0[1],
            m0 * (r0[2] + D0) + m1 * r1[1] + (m1 + m2 + m3) * (D0 + D1),
            m1 * r1[0],
            m1 * r1[2] + m2 * r2[2] + (m2 + m3) * D2 + m3 * (r3[2] + D3),
            m2 * r2[0] + (m2 + m3) * A2,
            m2 * r2[1],
            m3 * (r3[0] + A3),
            m3 * r3[1],
        ]
    )


def gravity_regressor(q, g):
    """G(q, g_t) of the fact sheet (3, 9)."""
    s1, c1, gx, gy, gz = np.sin(q[0]), np.cos(q[0]), *g
    columns = [
        [0, -gz, gy],
        [gz, 0, -gx],
        [-gy, gx, 0],
        [s1 * gz, -c1 * gz, c1 * gy - s1 * gx],
        [-c1 * gz, -s1 * gz, s1 * gy + c1 * gx],
    ]
    for angle in (q[1], q[1] + q[2]):
        s, c = np.sin(angle), np.cos(angle)
        columns.append([s1 * c * gz - s * gy, -c1 * c * gz + s * gx, c1 * c * gy - s1 * c * gx])
        columns.append([-s1 * s * gz - c * gy, c1 * s * gz + c * gx, -c1 * s * gy + s1 * s * gx])
    return np.array(columns).T


def gravity_wrench_in_sensor(pose, q):
    """Weight of the payload on the platform, in axes and about the origin of s."""
    g = Rotation.from_euler("xyz", pose[3:]).as_matrix().T @ [0.0, 0.0, -GRAVITY]
    force, moment = sum(MASS) * g, gravity_regressor(q, g) @ first_moments()
    flip = np.diag([1.0, -1.0, -1.0])
    return np.concatenate([flip @ force, flip @ (moment - np.cross(SENSOR, force))])


def test_the_rig_has_39_degrees_of_freedom_and_9_drives(rig):
    """Six legs of 5, a free platform, three joints; a cylinder each and a motor each."""
    assert rig.model.nv == 6 * 5 + 6 + 3
    assert rig.model.nu == 9


def test_the_sensor_carries_93_7_kg(rig):
    assert abs(rig.model.body_subtreemass[rig.layout.sensor_body] - 93.7) < 1e-12


def test_the_moving_mass_is_legs_platform_and_payload(rig):
    total = rig.model.body_subtreemass[0]
    assert abs(total - (6 * (8.0 + 2.5) + 60.0 + 93.7)) < 1e-9


def standalone(file):
    return mujoco.MjModel.from_xml_path(str(mjcf_part(file)))


PARTS = [("platform.xml", "platform/"), ("sensor.xml", "sensor/"), ("puma560.xml", "arm/")]
PARTS += [("leg.xml", f"leg{leg}/") for leg in range(1, 7)]


@pytest.mark.parametrize(("file", "prefix"), PARTS)
def test_bodies_of_a_part_keep_the_numbers_of_its_file(rig, file, prefix):
    part = standalone(file)
    for i in range(1, part.nbody):
        alone = part.body(i)
        joined = rig.model.body(prefix + alone.name)
        for field in ("mass", "inertia", "iquat"):
            np.testing.assert_allclose(
                getattr(joined, field), getattr(alone, field), rtol=0, atol=SAME_NUMBER
            )
        np.testing.assert_allclose(joined.ipos, alone.ipos, rtol=0, atol=WRITTEN_DIGITS)
        if part.body_parentid[i]:  # a root's place is where it is attached
            np.testing.assert_allclose(joined.pos, alone.pos, rtol=0, atol=SAME_NUMBER)
            np.testing.assert_allclose(joined.quat, alone.quat, rtol=0, atol=SAME_NUMBER)


@pytest.mark.parametrize(("file", "prefix"), PARTS)
def test_joints_of_a_part_keep_the_numbers_of_its_file(rig, file, prefix):
    part = standalone(file)
    for i in range(part.njnt):
        alone = part.joint(i)
        joined = rig.model.joint(prefix + alone.name)
        assert joined.type == alone.type
        for field in ("damping", "stiffness", "armature", "pos", "axis"):
            np.testing.assert_allclose(
                getattr(joined, field), getattr(alone, field), rtol=0, atol=SAME_NUMBER
            )


@pytest.mark.parametrize(("file", "prefix"), PARTS)
def test_sites_of_a_part_keep_the_places_of_its_file(rig, file, prefix):
    part = standalone(file)
    for i in range(part.nsite):
        alone = part.site(i)
        joined = rig.model.site(prefix + alone.name)
        np.testing.assert_allclose(joined.pos, alone.pos, rtol=0, atol=WRITTEN_DIGITS)
        np.testing.assert_allclose(joined.quat, alone.quat, rtol=0, atol=SAME_NUMBER)


def test_a_changed_parameter_reaches_the_model(plant):
    changed = plant.with_values(
        {"platform.mass": 61.0, "leg.bending_stiffness": 1600.0, "arm.armature": [1.0, 2.0, 3.0]}
    )
    model = assemble(changed, 1e-3).compile()
    assert model.body("platform/top").mass == 61.0
    assert model.joint("leg3/bending_y").stiffness[0] == 1600.0
    assert [model.joint(f"arm/q{i}").armature[0] for i in (1, 2, 3)] == [1.0, 2.0, 3.0]
    assert model.opt.timestep == 1e-3


def test_the_loop_closes_at_every_pose(rig, placements):
    for pose, q in placements:
        rig.place(pose, q)
        mujoco.mj_kinematics(rig.model, rig.data)
        for leg in range(1, 7):
            rod = rig.data.site(f"leg{leg}/rod_end").xpos
            joint = rig.data.site(f"platform/joint{leg}").xpos
            np.testing.assert_allclose(rod, joint, rtol=0, atol=CLOSURE)


def test_the_top_site_stands_at_the_commanded_pose(rig, placements):
    for pose, q in placements:
        rig.place(pose, q)
        mujoco.mj_kinematics(rig.model, rig.data)
        top = rig.data.site("platform/top")
        np.testing.assert_allclose(
            top.xpos, rig.plant.geometry.home + pose[:3], rtol=0, atol=CLOSURE
        )
        expected = Rotation.from_euler("xyz", pose[3:]).as_matrix()
        np.testing.assert_allclose(top.xmat.reshape(3, 3), expected, rtol=0, atol=CLOSURE)


def test_the_fact_sheet_s_first_moments_are_computed_here():
    """P as printed there to three digits; guards the helper, which the next test relies on."""
    expected = [0, 0, 63.171, 0, -5.985, 5.066, -0.104, 2.620, 0]
    np.testing.assert_allclose(first_moments(), expected, rtol=0, atol=0.001)


def test_at_rest_the_sensor_reads_the_gravity_wrench(rig, placements, figure):
    """MuJoCo reads what the platform does to the payload: minus the payload's weight."""
    model, data = rig.model, rig.data
    at = rig.layout.wrench_sensor
    scale = np.repeat([sum(MASS) * GRAVITY, 60.0], 3)
    worst = 0.0
    for pose, q in placements:
        rig.place(pose, q)
        data.qacc[:] = 0.0
        mujoco.mj_inverse(model, data)
        mujoco.mj_sensorAcc(model, data)
        reading = -data.sensordata[at : at + 6]
        expected = gravity_wrench_in_sensor(pose, q)
        worst = max(worst, np.max(np.abs(reading - expected) / scale))
    figure("static sensor reading against the gravity wrench, 50 poses", worst, STATIC, "relative")


def test_level_and_stretched_the_arm_weighs_as_the_thesis_computes():
    """Fact sheet 5: M_g about t = (-58.7, 75.4, 0) N m at q = 0."""
    g = np.array([0.0, 0.0, -GRAVITY])
    moment = gravity_regressor(np.zeros(3), g) @ first_moments()
    np.testing.assert_allclose(moment, [-58.7, 75.4, 0.0], rtol=0, atol=0.05)


def test_the_closure_holds_the_rig_together_under_its_weight(rig, plant):
    """10 ms with the drives off: the platform sinks, the loop stays closed."""
    model = rig.model
    data = mujoco.MjData(model)
    place_rig(data, rig.layout, plant.geometry, np.zeros(6), np.array([0.0, 1.0, 0.5]))
    mujoco.mj_step(model, data, nstep=30)
    gaps = [
        np.linalg.norm(data.site(f"leg{i}/rod_end").xpos - data.site(f"platform/joint{i}").xpos)
        for i in range(1, 7)
    ]
    assert max(gaps) < 1e-5  # "closed to micrometres" (CLOSURE_SOLIMP)
    assert data.body("platform/top").xpos[2] < plant.geometry.home[2]
