"""Laws that every controller and every gravity compensation obeys."""

import copy

import numpy as np
import pytest

from ves_twin.control.gravity import GravityCompensation, GravityTask
from ves_twin.control.registry import GRAVITY_COMPENSATIONS, PLATFORM_CONTROLLERS
from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.gravity.learned import LearnedGravity, PlannedExperiment

PERIOD = 1.0 / 80.0


class KnownGravity:
    """A truth port with a wrench of its own."""

    wrench = np.array([1.0, -2.0, 919.0, 4.0, -5.0, 6.0])

    def gravity_in_sensor(self) -> np.ndarray:
        return self.wrench.copy()


@pytest.fixture
def series(readings, belief):
    """40 cycles of readings that look like a moving arm on a moving platform."""
    rng = np.random.default_rng(14)
    poses = np.cumsum(rng.normal(size=(40, 6)), axis=0) * 0.002
    wrenches = np.cumsum(rng.normal(size=(40, 6)), axis=0)
    return [
        readings(
            wrench_in_sensor=wrench,
            arm_q=rng.normal(size=3),
            leg_length=belief.geometry.lengths(pose),
        )
        for wrench, pose in zip(wrenches, poses, strict=True)
    ]


@pytest.fixture(params=sorted(PLATFORM_CONTROLLERS))
def controller(request):
    return PLATFORM_CONTROLLERS[request.param]


@pytest.fixture(params=sorted(GRAVITY_COMPENSATIONS))
def compensation(request, belief) -> GravityCompensation:
    planned = PlannedExperiment("sensor", "system", (0.0,) * 6, PERIOD, np.zeros((30, 3)))
    learned = LearnedGravity(np.random.default_rng(3).normal(size=(30, 6)), planned, "a test")
    return GRAVITY_COMPENSATIONS[request.param](GravityTask(belief, KnownGravity(), learned))


def test_the_learning_method_without_its_wrench_is_refused(belief):
    with pytest.raises(InvalidInputError, match=r"gravity\.file"):
        GRAVITY_COMPENSATIONS["learned"](GravityTask(belief, KnownGravity()))


def commands(built, series, first=0):
    rows = [built.update((first + k) * PERIOD, r).copy() for k, r in enumerate(series)]
    return np.array(rows)


def estimates(built, series):
    return np.array([built.wrench(k * PERIOD, r).copy() for k, r in enumerate(series)])


def test_a_command_is_six_finite_numbers(controller, task, series):
    pose = controller.build(task).update(0.0, series[0])
    assert type(pose) is np.ndarray
    assert pose.shape == (6,)
    assert pose.dtype == np.float64
    assert np.all(np.isfinite(commands(controller.build(task), series)))


def test_the_controller_moves_the_platform(controller, task, series):
    assert np.ptp(commands(controller.build(task), series), axis=0).max() > 1e-4


def test_equal_readings_give_equal_commands(controller, task, series):
    one, two = (commands(controller.build(task), series) for _ in range(2))
    np.testing.assert_array_equal(one, two)


def test_two_controllers_of_one_task_do_not_share_state(controller, task, series):
    alone = commands(controller.build(task), series)
    one, two = controller.build(task), controller.build(task)
    mixed = []
    for k, reading in enumerate(series):
        two.update(k * PERIOD, series[0])
        mixed.append(one.update(k * PERIOD, reading).copy())
    np.testing.assert_array_equal(mixed, alone)


def test_going_back_to_a_snapshot_repeats_bitwise(controller, task, series):
    built = controller.build(task)
    commands(built, series[:15])
    kept = built.snapshot()
    copied = copy.deepcopy(kept)
    first = commands(built, series[15:], first=15)
    built.restore(kept)
    np.testing.assert_array_equal(commands(built, series[15:], first=15), first)
    other = controller.build(task)
    other.restore(copied)
    np.testing.assert_array_equal(commands(other, series[15:], first=15), first)


def test_readings_stay_as_they_were(controller, task, series):
    built = controller.build(task)
    before = [copy.deepcopy(vars(reading)) for reading in series]
    commands(built, series)  # writing into them would raise: they are read-only
    for reading, kept in zip(series, before, strict=True):
        for name, value in kept.items():
            np.testing.assert_array_equal(getattr(reading, name), value)


def test_an_estimate_is_six_finite_numbers(compensation, series):
    wrench = compensation.wrench(0.0, series[0])
    assert wrench.shape == (6,)
    assert np.all(np.isfinite(estimates(compensation, series)))


def test_estimates_repeat_from_a_snapshot(compensation, series):
    estimates(compensation, series[:15])
    kept = compensation.snapshot()
    first = estimates(compensation, series[15:])
    compensation.restore(kept)
    np.testing.assert_array_equal(estimates(compensation, series[15:]), first)


def test_a_compensation_that_does_not_subtract_estimates_nothing(compensation, series):
    assert compensation.subtracts == bool(np.any(estimates(compensation, series)))


def test_the_truth_is_what_the_port_says(series, belief):
    truth = GRAVITY_COMPENSATIONS["truth"](GravityTask(belief, KnownGravity()))
    np.testing.assert_array_equal(truth.wrench(0.0, series[0]), KnownGravity.wrench)
