"""The admittance controller moves as its emulated base would."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ves_twin.control.admittance import AdmittanceController
from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.kinematics.wrenches import sensor_to_top, top_to_sensor

ROUND_OFF = 1e-12
"""m and rad, after up to 1000 cycles whose spectral radius is below one."""
SETTLED = 1e-9
"""Table 5-2's slowest pole is -0.5 1/s: e^-30 = 1e-13 of the start is left after 60 s."""


@pytest.fixture
def table(task):
    """The decoupled model of Table 5-2 at 85 Hz, released at home."""
    system = EmulatedSystem.load("table_5_2")
    return dataclasses.replace(task, emulated=system, period=1 / 85, start=np.zeros(6))


def run(controller, cycles, reading):
    return np.array([controller.update(k / 85, reading) for k in range(cycles)])


def top_wrench(table, wrench, readings, **more):
    """Readings under which the platform feels a wrench about t, in its own axes."""
    sensed = top_to_sensor(np.asarray(wrench, float), np.array(table.belief.sensor_position))
    return readings(wrench_in_sensor=sensed, **more)


def test_without_a_wrench_a_released_base_swings_as_the_closed_form_says(table, readings):
    """Table 5-2: x'' + 2 d x' + w^2 x = 0, each axis alone, released at rest."""
    start = np.array([0.2, -0.2, 0.1, *np.radians([10.0, -10.0, 20.0])])
    controller = AdmittanceController.build(dataclasses.replace(table, start=start))
    poses = run(controller, 800, readings())
    time = np.arange(1, 801) / 85  # the command of cycle k is where the base is at k + 1
    mass = np.array([500.0, 500.0, 500.0, 250.0, 250.0, 250.0])
    stiffness = np.array([1500.0, 2500.0, 4000.0, 1500.0, 1000.0, 2000.0])
    d = mass / (2 * mass)  # B equals M in numbers
    w = np.sqrt(stiffness / mass - d**2)
    t = time[:, None]
    expected = start * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))
    np.testing.assert_allclose(poses, expected, rtol=0, atol=ROUND_OFF)


def test_a_small_constant_wrench_bends_the_base_by_its_compliance(table, readings):
    wrench = np.array([1.0, 2.0, -3.0, 1e-3, 2e-3, 1e-3])
    controller = AdmittanceController.build(table)
    pose = run(controller, 5200, top_wrench(table, wrench, readings))[-1]
    expected = np.linalg.solve(table.emulated.stiffness, wrench)
    # the wrench turns with the platform, by 2e-6 rad: 1e-8 m
    np.testing.assert_allclose(pose, expected, rtol=0, atol=2e-8)


def test_under_a_large_constant_wrench_the_base_balances_the_turned_wrench(table, readings):
    wrench = np.array([50.0, -40.0, -60.0, 40.0, 30.0, -50.0])
    controller = AdmittanceController.build(table)
    pose = run(controller, 5200, top_wrench(table, wrench, readings))[-1]
    r = Rotation.from_euler("xyz", pose[3:]).as_matrix()
    turned = np.concatenate([r @ wrench[:3], r @ wrench[3:]])
    np.testing.assert_allclose(table.emulated.stiffness @ pose, turned, rtol=0, atol=1e-6)
    assert np.max(np.abs(turned - wrench)) > 1.0  # the turn matters here


def test_motion_is_counted_from_home(table, readings):
    home = np.array([0.05, 0.02, -0.1, 0.0, 0.0, 0.0])
    shifted = dataclasses.replace(table, home=home, start=home)
    reading = top_wrench(table, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0], readings)
    there = run(AdmittanceController.build(shifted), 100, reading)
    here = run(AdmittanceController.build(table), 100, reading)
    np.testing.assert_allclose(there - home, here, rtol=0, atol=ROUND_OFF)


def test_the_wrench_is_turned_by_the_attitude_of_home_too(table, readings):
    home = np.array([0.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2])
    turned = dataclasses.replace(table, home=home, start=home)
    reading = top_wrench(table, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0], readings)
    pose = AdmittanceController.build(turned).update(0.0, reading) - home
    assert pose[1] > 0.0
    assert abs(pose[0]) < 1e-12


@pytest.mark.parametrize("subtract", [True, False])
def test_the_gravity_estimate_is_taken_off_only_if_asked(table, readings, subtract):
    weight = np.array([5.0, -3.0, 919.0, 10.0, -20.0, 1.0])
    told = dataclasses.replace(table, subtract_gravity=subtract)
    reading = readings(wrench_in_sensor=weight, gravity_in_sensor=weight)
    moved = np.max(np.abs(run(AdmittanceController.build(told), 50, reading)))
    assert moved == 0.0 if subtract else moved > 1e-3


def test_a_force_at_the_sensor_is_a_moment_at_the_top(table, readings):
    """One cycle from rest: the pose is Gamma W with W about the origin of t."""
    sensed = np.array([80.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    pose = AdmittanceController.build(table).update(0.0, readings(wrench_in_sensor=sensed))
    _, gamma = table.emulated.discretise(table.period)
    wrench = sensor_to_top(sensed, np.array(table.belief.sensor_position))
    np.testing.assert_allclose(pose, gamma[:6] @ wrench, rtol=0, atol=1e-16)
    assert pose[4] > 0.0  # z0 Fx about y


def test_the_command_is_a_fresh_array(table, readings):
    controller = AdmittanceController.build(table)
    reading = top_wrench(table, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0], readings)
    expected = run(AdmittanceController.build(table), 2, reading)[1]
    controller.update(0.0, reading)[:] = 7.0
    np.testing.assert_array_equal(controller.update(1 / 85, reading), expected)


def test_without_an_emulated_system_it_is_refused(task):
    with pytest.raises(InvalidInputError, match="emulated"):
        AdmittanceController.build(dataclasses.replace(task, emulated=None))
