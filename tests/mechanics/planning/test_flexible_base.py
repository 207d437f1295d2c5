"""Linear dynamics: the poles of the thesis, MuJoCo's linearisation, energy."""

import mujoco
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.planning.flexible_base import (
    HIGH_GAINS,
    PPED_GAINS,
    FlexibleBaseArm,
    JointGains,
    strain_energy,
)
from ves_twin.plant.assembly import assemble_free_arm, compile_model

POLES = 0.0005
"""Half of the third decimal of facts.md section 7."""
LINEARISATION = 1e-8
"""Relative to the largest entry of its row: asked. Differences of 1e-6 leave round-off below."""

PPED_POLES = [
    -0.695, -0.025 + 0.758j, -0.029 + 0.851j, -0.061 + 1.103j, -1.970 + 0.063j,
    -0.152 + 2.923j, -0.174 + 3.761j, -0.229 + 4.475j, -5.191 + 1.901j, -17.892,
]  # fmt: skip
BASE_ORDER = np.array([0, 1, 2, 5, 4, 3])
"""MuJoCo's base joints are x y z rz ry rx; ours end in rx ry rz."""

HIGH_POLES = [
    -0.025 + 0.758j, -0.029 + 0.851j, -0.061 + 1.103j, -0.121 + 2.907j, -0.172 + 3.759j,
    -0.191 + 4.466j, -1.671 + 12.234j, -3.624 + 20.539j, -13.758 + 28.115j,
]  # fmt: skip


@pytest.mark.parametrize(
    ("gains", "expected"), [(PPED_GAINS, PPED_POLES), (HIGH_GAINS, HIGH_POLES)]
)
def test_18_poles_are_those_of_the_recomputed_thesis(
    printed_puma, bent, gains, expected, pped_pose
):
    poles = FlexibleBaseArm.about(printed_puma, bent, pped_pose, gains).poles()
    assert len(poles) == 18
    upper = poles[poles.imag >= 0]
    assert len(upper) == len(expected)
    for pole in expected:
        nearest = upper[np.argmin(np.abs(upper - pole))]
        assert abs(nearest.real - pole.real) <= POLES
        assert abs(nearest.imag - pole.imag) <= POLES


def test_the_slow_poles_do_not_see_the_gains(printed_puma, bent, pped_pose):
    """C068: first three pairs move by less than 0.01."""
    slow = [
        FlexibleBaseArm.about(printed_puma, bent, pped_pose, gains).poles()
        for gains in (PPED_GAINS, HIGH_GAINS)
    ]
    first = [poles[poles.imag > 0][:3] for poles in slow]
    assert np.max(np.abs(first[0] - first[1])) < 0.01


def test_the_middle_poles_turn_onto_the_real_axis(printed_puma, bent, pped_pose):
    """C069: imaginary over real part of the pairs at -2 to -5 falls more than 5 times."""
    high, low = ([-1.671 + 12.234j, -3.624 + 20.539j], [-1.970 + 0.063j, -5.191 + 1.901j])
    for gains, near in ((HIGH_GAINS, high), (PPED_GAINS, low)):
        poles = FlexibleBaseArm.about(printed_puma, bent, pped_pose, gains).poles()
        for pole in near:
            assert np.min(np.abs(poles - pole)) < 0.001
    for before, after in zip(high, low, strict=True):
        assert abs(before.imag / before.real) > 5 * abs(after.imag / after.real)


@pytest.mark.parametrize("gains", [PPED_GAINS, HIGH_GAINS])
def test_split_inertias_agree_with_mujoco_s_linearisation(plant, puma, bent, gains, pped_pose):
    """Differences of MuJoCo's acceleration with M, B, K of the base applied as forces."""
    spec = assemble_free_arm(plant.with_values({"arm.damping": [0.0, 0.0, 0.0]}))
    model = compile_model(spec)
    data = mujoco.MjData(model)
    order = np.concatenate([BASE_ORDER, [6, 7, 8]])
    linear = FlexibleBaseArm.about(puma, bent, pped_pose, gains)

    def acceleration(x, rate):
        data.qpos[order], data.qvel[order] = x, rate
        data.qpos[6:] += pped_pose
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        full = np.zeros((9, 9))
        mujoco.mj_fullM(model, data, full)
        full = full[np.ix_(order, order)]
        full[:6, :6] += bent.mass
        force = -linear.stiffness @ x - linear.damping @ rate - data.qfrc_bias[order]
        return np.linalg.solve(full, force)

    h = 1e-6
    found = np.zeros((9, 18))
    for i in range(9):
        e, zero = h * np.eye(9)[i], np.zeros(9)
        found[:, i] = (acceleration(e, zero) - acceleration(-e, zero)) / (2 * h)
        found[:, 9 + i] = (acceleration(zero, e) - acceleration(zero, -e)) / (2 * h)
    expected = linear.state_matrix[9:]
    scale = np.max(np.abs(expected), axis=1, keepdims=True)
    assert np.max(np.abs(found - expected) / scale) < LINEARISATION


def test_rotors_as_armature_move_one_pair_as_the_errata_say(puma, bent, pped_pose):
    """E-28: -1.97 +- 0.06j becomes -1.57 and -2.95."""
    poles = FlexibleBaseArm.about(puma, bent, pped_pose, PPED_GAINS).poles()
    for pole in (-1.570, -2.948):
        assert np.min(np.abs(poles - pole)) < 0.001


def test_energy_balances_over_a_release(puma, bent, pped_pose):
    """What the dampers take, integrated, is what the whole system loses."""
    arm = FlexibleBaseArm.about(puma, bent, pped_pose, PPED_GAINS)
    times = np.arange(0.0, 8.0, 0.0005)
    start = np.array([0.1, 0.1, 0.1, 0.0, 0.0, 0.0])
    x = arm.release(start, times)
    rate = np.gradient(x, times, axis=0, edge_order=2)
    energy = 0.5 * np.einsum("ki,ij,kj->k", x, arm.stiffness, x)
    energy += 0.5 * np.einsum("ki,ij,kj->k", rate, arm.mass, rate)
    lost = np.trapezoid(np.einsum("ki,ij,kj->k", rate, arm.damping, rate), times)
    # second-order differences of a 30 rad/s motion at 0.5 ms: 1e-4
    np.testing.assert_allclose(energy[0] - energy[-1], lost, rtol=1e-3)
    assert energy[-1] < 0.6 * energy[0]


def test_strain_energy_is_the_sum_over_the_elements(bent):
    y = np.array([0.1, -0.2, 0.05, 0.01, 0.02, -0.03])
    total = sum(0.5 * bent.stiffness[i, j] * y[i] * y[j] for i in range(6) for j in range(6))
    np.testing.assert_allclose(strain_energy(bent, y), total, rtol=1e-12)
    np.testing.assert_allclose(
        strain_energy(bent, np.array([0.1, 0.1, 0.1, 0, 0, 0])), 7.60, atol=0.005
    )


def test_gains_for_another_number_of_joints_are_refused(puma, bent, pped_pose):
    with pytest.raises(InvalidInputError, match=r"joint damping.*3 finite numbers"):
        FlexibleBaseArm.about(puma, bent, pped_pose, JointGains(np.ones(3), np.ones(2)))
