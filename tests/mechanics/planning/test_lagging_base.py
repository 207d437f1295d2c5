"""LaggingBaseArm: fast legs vanish, slow ones damp, and the nonlinear reference agrees."""

import numpy as np
import pytest
from scipy.linalg import expm

from ves_twin.control import arm_servo
from ves_twin.core.errors import VesTwinError
from ves_twin.mechanics.emulated import Coupling, EmulatedSystem
from ves_twin.mechanics.planning.flexible_base import PPED_GAINS, FlexibleBaseArm, JointGains
from ves_twin.mechanics.planning.lagging_base import LaggingBaseArm
from ves_twin.mechanics.planning.pped import strain_energy_integral
from ves_twin.simulator.reference import ZeroGravityReference

START = np.array([0.1, 0.1, 0.1, 0.0, 0.0, 0.0])
LEGS = (12.6, 0.004)


def test_infinitely_fast_legs_leave_the_flexible_base(puma, bent, pped_pose):
    mass = puma.mass_matrix(pped_pose)
    ideal = FlexibleBaseArm.of(mass, bent, PPED_GAINS)
    expected = strain_energy_integral(ideal, START, 30.0)
    errors = []
    for speed in (1.0, 10.0):
        arm = LaggingBaseArm(mass, bent, PPED_GAINS, 1e3 * speed, 1e-5 / speed)
        errors.append(abs(arm.energy_integral(START, 30.0) / expected - 1.0))
    assert errors[0] < 0.02
    np.testing.assert_allclose(errors[0] / errors[1], 10.0, rtol=0.1)  # first order in the lag


def test_slow_legs_damp_a_mode_by_tau_omega_squared_times_what_they_carry():
    m, h, k, tau = 300.0, 100.0, 600.0, 0.01
    base = EmulatedSystem("one", Coupling.DECOUPLED, *(x * np.eye(6) for x in (m, 5.0, k)), "")
    none = JointGains(np.zeros(0), np.zeros(0))
    arm = LaggingBaseArm(h * np.eye(6), base, none, 1.0 / tau, 1e-6)
    slow = arm.poles()[0]
    omega = np.sqrt(k / (m + h))
    damping = 5.0 + tau * omega**2 * h
    np.testing.assert_allclose(-slow.real, damping / 2 / (m + h), rtol=3 * omega * tau)


def test_the_integral_is_that_of_the_motion(puma, bent, pped_pose):
    arm = LaggingBaseArm(puma.mass_matrix(pped_pose), bent, PPED_GAINS, *LEGS)
    step, state, energies = expm(arm.state_matrix * 0.005), np.zeros(30), []
    state[:6] = state[12:18] = START
    for _ in range(2001):
        energies.append(0.5 * state[12:18] @ bent.stiffness @ state[12:18])
        state = step @ state
    by_steps = np.trapezoid(energies, dx=0.005)
    np.testing.assert_allclose(arm.energy_integral(START, 10.0), by_steps, rtol=1e-4)


def test_it_is_the_small_motion_of_the_nonlinear_reference_behind_legs(
    plant, puma, bent, pped_pose
):
    """A hundredth of the thesis's start pose; friction of the joints added to their gains."""
    servo = np.zeros(1, arm_servo.PARAMETERS)
    servo["stiffness"], servo["damping"] = PPED_GAINS.stiffness, PPED_GAINS.damping
    servo["limit"], servo["cycle"] = 1e3, 0.0125
    small, zero = START / 100, np.zeros(6)
    reference = ZeroGravityReference(plant, bent, servo, small, zero, pped_pose, LEGS)
    friction = plant.parameters.array("arm.damping")
    gains = JointGains(PPED_GAINS.stiffness, PPED_GAINS.damping + friction)
    arm = LaggingBaseArm(puma.mass_matrix(pped_pose), bent, gains, *LEGS)
    step, state = expm(arm.state_matrix * 0.0125), np.zeros(30)
    state[:6] = state[12:18] = small
    reference.advance(np.tile(pped_pose, (240, 4, 1)), 0.0125)
    for _ in range(240):
        state = step @ state
    np.testing.assert_allclose(reference.pose, state[12:18], rtol=0, atol=1e-5)  # of 1e-3


def test_impossible_legs_are_refused(puma, bent, pped_pose):
    with pytest.raises(VesTwinError, match="above zero"):
        LaggingBaseArm(puma.mass_matrix(pped_pose), bent, PPED_GAINS, 12.6, 0.0)
