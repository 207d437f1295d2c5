"""The arm's dynamics against Pinocchio, against the fact sheet, and its energy balance."""

import mujoco
import numpy as np
import pytest

from ves_twin.plant.assembly import assemble_fixed_arm, assemble_free_arm

# Thesis Appendix B and errata E-28, typed here again on purpose.
D0, D1, D2, D3, A2, A3 = 0.22844, 0.672, -0.2435, 0.098, 0.4318, 0.4331
MASS = [12.8, 17.4, 9.0]
COM = [[0.0, 0.0, -0.056], [-0.364, -0.006, 0.016], [-0.142, 0.0, 0.0]]
INERTIA = [[0.615, 0.615, 0.081], [0.130, 0.524, 0.539], [0.020, 0.574, 0.594]]
ARMATURE = [1.14, 4.71, 0.83]

TWO_ENGINES = 1e-8
"""kg m^2 and N m: the XML turns link 1 by a quaternion of 17 digits; the rest is round-off."""
DRIFT = 1e-6
"""Of the energy over 10 s: RK4 of step h errs by (w h)^4 with w of some rad/s, far below it."""
PRINTED = 0.005
"""Half of the last digit of the fact sheet's 7.63 kg m^2."""
STEP = 341e-6


def full_mass_matrix(model, data):
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return mass


@pytest.fixture(scope="module")
def fixed(plant):
    model = assemble_fixed_arm(plant).compile()
    return model, mujoco.MjData(model)


@pytest.fixture(scope="module")
def other_engine():
    """The same arm in Pinocchio: joint about z, then the constant part of each DH transform."""
    pin = pytest.importorskip("pinocchio")
    model = pin.Model()
    quarter = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    constant = [
        pin.SE3(quarter, np.array([0.0, 0.0, D0 + D1])),
        pin.SE3(np.eye(3), np.array([A2, 0.0, D2])),
        pin.SE3(np.eye(3), np.array([A3, 0.0, D3])),
    ]
    parent, placement = 0, pin.SE3.Identity()
    for i in range(3):
        parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"q{i + 1}")
        link = pin.Inertia(MASS[i], np.array(COM[i]), np.diag(INERTIA[i]))
        model.appendBodyToJoint(parent, link, constant[i])
        placement = constant[i]
    model.armature = np.array(ARMATURE)
    model.gravity.linear = np.array([0.0, 0.0, -9.81])
    return pin, model, model.createData()


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(6)
    return list(zip(rng.uniform(-np.pi, np.pi, (100, 3)), rng.normal(0, 2, (100, 3)), strict=True))


def test_the_mass_matrix_equals_pinocchio(fixed, other_engine, states, figure):
    model, data = fixed
    worst = 0.0
    pin, arm, work = other_engine
    for q, _ in states:
        data.qpos[:], data.qvel[:] = q, 0.0
        mujoco.mj_forward(model, data)
        upper = np.triu(pin.crba(arm, work, q))
        expected = upper + np.triu(upper, 1).T
        worst = max(worst, np.max(np.abs(full_mass_matrix(model, data) - expected)))
    figure("PUMA mass matrix against Pinocchio, 100 states", worst, TWO_ENGINES, "kg m^2")


def test_the_bias_forces_equal_pinocchio(fixed, other_engine, states, figure):
    model, data = fixed
    worst = 0.0
    pin, arm, work = other_engine
    for q, rate in states:
        data.qpos[:], data.qvel[:] = q, rate
        mujoco.mj_forward(model, data)
        expected = pin.nonLinearEffects(arm, work, q, rate)
        worst = max(worst, np.max(np.abs(data.qfrc_bias - expected)))
    figure("PUMA bias forces against Pinocchio, 100 states", worst, TWO_ENGINES, "N m")


def test_the_gravity_torques_equal_pinocchio(fixed, other_engine, states, figure):
    model, data = fixed
    worst = 0.0
    pin, arm, work = other_engine
    for q, _ in states:
        data.qpos[:], data.qvel[:] = q, 0.0
        mujoco.mj_forward(model, data)
        expected = pin.computeGeneralizedGravity(arm, work, q)
        worst = max(worst, np.max(np.abs(data.qfrc_bias - expected)))
    figure("PUMA gravity torques against Pinocchio, 100 states", worst, TWO_ENGINES, "N m")


def test_the_tip_lies_where_pinocchio_puts_it(fixed, other_engine, states):
    model, data = fixed
    pin, arm, work = other_engine
    for q, _ in states:
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        pin.forwardKinematics(arm, work, q)
        expected = work.oMi[3].act(np.array([A3, 0.0, D3]))
        np.testing.assert_allclose(data.site("tip").xpos, expected, rtol=0, atol=TWO_ENGINES)


def test_friction_brakes_each_joint_by_its_own_coefficient(fixed, plant):
    model, data = fixed
    data.qpos[:], data.qvel[:] = [0.3, 0.4, 0.5], [1.0, -2.0, 3.0]
    mujoco.mj_forward(model, data)
    expected = -np.array([5.80, 9.50, 3.98]) * data.qvel
    np.testing.assert_allclose(data.qfrc_damper, expected, rtol=1e-14)


def test_energy_is_kept_without_gravity_and_friction(plant, figure):
    quiet = plant.with_values({"gravity": 0.0, "arm.damping": [0.0, 0.0, 0.0]})
    spec = assemble_fixed_arm(quiet)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = STEP
    model = spec.compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(7)
    data.qpos[:], data.qvel[:] = rng.uniform(-np.pi, np.pi, 3), rng.normal(0, 1.5, 3)
    energies = []
    for _ in range(11):
        mujoco.mj_forward(model, data)
        energies.append(0.5 * data.qvel @ full_mass_matrix(model, data) @ data.qvel)
        mujoco.mj_step(model, data, nstep=round(1.0 / STEP))
    moved = np.ptp(energies) / energies[0]
    figure("arm without gravity: energy drift in 10 s, RK4", moved, DRIFT, "")
    assert moved > 0.0  # exactly zero would mean that nothing moved


def test_stretched_inertia_about_the_first_axis_is_the_fact_sheet_s(fixed):
    model, data = fixed
    data.qpos[:] = 0.0
    mujoco.mj_forward(model, data)
    assert abs(full_mass_matrix(model, data)[0, 0] - ARMATURE[0] - 7.63) < PRINTED


@pytest.fixture(scope="module")
def payload(plant):
    """Rigid mass matrix of the arm at q = 0 about t, order x y z phiX phiY phiZ."""
    model = assemble_free_arm(plant).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    order = [0, 1, 2, 5, 4, 3]
    return full_mass_matrix(model, data)[np.ix_(order, order)]


def test_the_payload_s_inertia_about_the_top_frame_is_the_fact_sheet_s(payload):
    """Its 63.9 about y counts the rotors of joints 2 and 3, which are no inertia of the base."""
    np.testing.assert_allclose(np.diag(payload)[:3], 93.7, rtol=0, atol=1e-12)
    rotors = np.array([0.0, ARMATURE[1] + ARMATURE[2], 0.0])
    np.testing.assert_allclose(np.diag(payload)[3:] + rotors, [54.4, 63.9, 9.44], rtol=0, atol=0.05)


@pytest.mark.parametrize(
    ("m44", "m66", "printed"),
    [
        (2900.0, 5.0, [0.111, 0.132, 0.158, 0.428, 5.19, 40.2]),
        (5.0, 2900.0, [0.111, 0.111, 0.424, 0.428, 1.75, 39.7]),
    ],
    ids=["as printed", "corrected"],
)
def test_the_beam_with_the_rigid_arm_has_the_fact_sheet_s_frequencies(payload, m44, m66, printed):
    from scipy.linalg import eigvalsh

    k = np.diag([7e6, 312.0, 312.0, 2800.0, 15000.0, 15000.0])
    k[1, 5] = k[5, 1] = 1870.0
    k[2, 4] = k[4, 2] = -1870.0
    mass = np.diag([20.0, 20.0, 20.0, m44, 2900.0, m66]) + payload
    found = np.sqrt(eigvalsh(k, mass)) / (2 * np.pi)
    np.testing.assert_allclose(found, printed, rtol=0.005)  # three printed digits


def test_the_free_arm_moves_as_the_platform_angles_say(plant):
    """Hinges in the order Z, Y, X make R = Rz Ry Rx: the base's attitude is the pose's."""
    from scipy.spatial.transform import Rotation

    model = assemble_free_arm(plant).compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(8)
    for _ in range(20):
        pose = rng.uniform(-1, 1, 6)
        data.qpos[:6] = [*pose[:3], pose[5], pose[4], pose[3]]
        mujoco.mj_kinematics(model, data)
        expected = Rotation.from_euler("xyz", pose[3:]).as_matrix()
        np.testing.assert_allclose(
            data.body("base").xmat.reshape(3, 3), expected, rtol=0, atol=1e-14
        )
        np.testing.assert_allclose(data.body("base").xpos, pose[:3], rtol=0, atol=1e-14)
