"""PPED: estimator and integrals of the thesis's gains, and gains that beat them."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.planning.flexible_base import (
    HIGH_GAINS,
    PPED_GAINS,
    FlexibleBaseArm,
    JointGains,
    strain_energy,
)
from ves_twin.mechanics.planning.pped import damping_estimator, search_gains, strain_energy_integral

START = np.array([0.1, 0.1, 0.1, 0.0, 0.0, 0.0])
"""Thesis 4.3.2."""


@pytest.fixture(scope="module")
def build(printed_puma, bent, pped_pose):
    arm_mass = printed_puma.mass_matrix(pped_pose)
    return lambda gains: FlexibleBaseArm.of(arm_mass, bent, gains)


@pytest.fixture(scope="module")
def least_energy(build):
    return search_gains(
        build, lambda arm: strain_energy_integral(arm, START), [PPED_GAINS, HIGH_GAINS]
    )


@pytest.mark.parametrize(("gains", "printed"), [(PPED_GAINS, 5.86), (HIGH_GAINS, 1.75)])
def test_the_estimator_has_the_value_of_the_thesis_gains(build, gains, printed):
    assert abs(damping_estimator(build(gains).poles()) - printed) < 0.01


@pytest.mark.parametrize(("gains", "expected"), [(PPED_GAINS, 18.65), (HIGH_GAINS, 20.58)])
def test_the_energy_integral_over_60_s_is_that_of_the_recomputation(build, gains, expected):
    """0.5 %: the recomputation is a sum of samples, 0.2 % above the integral."""
    np.testing.assert_allclose(
        strain_energy_integral(build(gains), START, 60.0), expected, rtol=0.005
    )


def test_the_integral_is_that_of_a_simulation(build, bent):
    arm = build(PPED_GAINS)
    a = arm.state_matrix
    state = np.concatenate([START, np.zeros(12)])
    times = np.linspace(0.0, 20.0, 4001)
    motion = solve_ivp(lambda _, x: a @ x, (0, 20), state, "DOP853", times, rtol=1e-10, atol=1e-12)
    simulated = np.trapezoid(strain_energy(bent, motion.y[:6].T), times)
    # trapezoids of 5 ms on a motion of 9 rad/s at twice its frequency: 1e-3
    np.testing.assert_allclose(strain_energy_integral(arm, START, 20.0), simulated, rtol=1e-3)
    np.testing.assert_allclose(arm.release(START, times)[-1], motion.y[:9, -1], rtol=0, atol=1e-8)


def test_a_mode_of_known_damping_has_a_known_integral():
    """m x'' + b x' + k x = 0 from x0 at rest: int 1/2 k x^2 = k x0^2 (b/2k + m/2b) / 2."""
    m, b, k, x0 = 3.0, 0.7, 50.0, 0.2
    rest = np.eye(5)
    arm = FlexibleBaseArm(
        np.diag([m, *np.diag(rest)]), np.diag([b, *np.diag(rest)]), np.diag([k, *np.diag(rest)])
    )
    start = np.array([x0, 0, 0, 0, 0, 0])
    expected = 0.5 * k * x0**2 * (b / (2 * k) + m / (2 * b))
    np.testing.assert_allclose(strain_energy_integral(arm, start), expected, rtol=1e-10)


def test_motion_that_does_not_die_out_has_no_integral(build):
    none = JointGains(np.zeros(3), np.zeros(3))
    assert strain_energy_integral(build(none), START) == np.inf


def test_gains_by_the_integral_beat_the_thesis_gains_by_more_than_25_percent(build, least_energy):
    thesis = strain_energy_integral(build(PPED_GAINS), START)
    assert least_energy.converged
    assert least_energy.value < 0.75 * thesis
    again = strain_energy_integral(build(least_energy.gains), START)
    np.testing.assert_allclose(again, least_energy.value, rtol=1e-9)


def test_no_small_change_of_the_found_gains_is_better(build, least_energy):
    best = np.concatenate([least_energy.gains.stiffness, least_energy.gains.damping])
    for i in range(6):
        for factor in (0.9, 1.1):
            other = best.copy()
            other[i] = max(other[i] * factor, 0.1)
            value = strain_energy_integral(build(JointGains(other[:3], other[3:])), START)
            assert value > least_energy.value - 1e-4


def test_the_estimator_is_degenerate(build):
    """E-37: it rises by 10 % as the springs vanish, and the base's energy stays what it was."""
    found = search_gains(
        build,
        lambda arm: -damping_estimator(arm.poles()),
        [PPED_GAINS, HIGH_GAINS],
        bounds=(1e-3, 1e4),
    )
    assert -found.value > 6.4
    assert max(found.gains.stiffness) < 0.05
    assert any(name.startswith("K") for name in found.at_bounds)
    ours = strain_energy_integral(build(found.gains), START)
    np.testing.assert_allclose(ours, strain_energy_integral(build(PPED_GAINS), START), rtol=0.01)


def test_wrong_searches_are_refused(build):
    with pytest.raises(InvalidInputError, match="bounds"):
        search_gains(build, lambda arm: 0.0, [PPED_GAINS], bounds=(1.0, 0.5))
    with pytest.raises(InvalidInputError, match="starts"):
        search_gains(build, lambda arm: 0.0, [])
    with pytest.raises(InvalidInputError, match="diagonal"):
        search_gains(build, lambda arm: 0.0, [JointGains(np.eye(3), np.ones(3))])
