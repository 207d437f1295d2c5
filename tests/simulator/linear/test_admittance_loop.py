"""The admittance loop of one axis: limits that are known, and its maps stepped."""

import numpy as np
import pytest

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.effects import SensorLag
from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.admittance_loop import AxisModel, admittance_loop, payload_mass
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.periodic import PeriodicSystem
from ves_twin.simulator.linear.stability_limit import stability_limit

RATE = 80.0


@pytest.fixture(scope="module")
def plant() -> Plant:
    return Plant.load("ves2")


def test_a_lasting_force_moves_the_platform_by_force_over_stiffness(plant):
    model = AxisModel.trial(300.0)
    for place in FilterPlace:
        loop = admittance_loop(plant, LegSettings(12.6, 0.1, place), model, RATE)
        # the loop's period of 0.19 s leaves 1e-15 / (1 - z) of round-off
        assert loop.lifted().dcgain() == pytest.approx(1.0 / model.stiffness, rel=1e-6)


def test_under_a_heavy_model_the_platform_swings_with_payload_and_model_together(plant):
    """A rigid payload adds its mass: omega = sqrt(k / (m + payload)); the lag costs damping."""
    model = AxisModel.trial(2000.0)
    loop = admittance_loop(plant, LegSettings(30.0), model, RATE)
    slow = loop.poles()[0]
    together = np.sqrt(model.stiffness / (model.mass + payload_mass(plant)))
    assert abs(slow) == pytest.approx(together, rel=1e-3)


def test_stepping_the_maps_grows_at_the_rate_of_the_leading_pole(plant):
    settings = LegSettings(20.9, place=FilterPlace.ERROR)
    loop = admittance_loop(plant, settings, AxisModel.trial(0.3 * payload_mass(plant)), RATE)
    state = np.random.default_rng(3).normal(size=loop.maps.shape[1])
    sizes = []
    for k in range(40 * len(loop.maps)):
        if k % len(loop.maps) == 0:
            sizes.append(np.linalg.norm(state))
        state = loop.maps[k % len(loop.maps)] @ state
    growth = np.polyfit(np.arange(20) * loop.period, np.log(sizes[-20:]), 1)[0]
    assert loop.growth == pytest.approx(growth, rel=0.02)  # the phase at each look differs
    assert loop.poles()[0].real == pytest.approx(loop.growth, rel=1e-9)


def test_the_turns_of_a_mode_are_counted_beyond_the_fold_of_the_period():
    """A spiral of 8 Hz, seen once in 0.2 s, would fold to 2 Hz."""
    pole, tick = complex(-1.0, 2 * np.pi * 8.0), 1e-3
    turn = np.exp(pole * tick)
    spiral = np.array([[turn.real, -turn.imag], [turn.imag, turn.real]])
    system = PeriodicSystem(
        np.repeat(spiral[None], 200, axis=0), np.zeros((200, 2)), np.ones(2), np.ones(2), tick
    )
    found = system.poles()
    np.testing.assert_allclose(sorted(found.imag), [-pole.imag, pole.imag], rtol=1e-9)
    np.testing.assert_allclose(found.real, pole.real, rtol=1e-9)


def test_the_limits_of_the_model_mass_are_those_of_5_4(plant, figure):
    error, feedback, none = (
        stability_limit(plant, LegSettings(20.9, place=place), RATE)
        for place in (FilterPlace.ERROR, FilterPlace.FEEDBACK, FilterPlace.NONE)
    )
    figure("linear limit, filter on the error, off 0.55 of the payload", abs(error - 0.55), 0.1, "")
    figure("linear limit, filter on the feedback, of the payload", feedback, 0.4, "")
    assert feedback < 0.5 * error
    assert none < 0.5 * error


def test_the_limit_separates_stable_from_unstable_models(plant):
    settings = LegSettings(20.9, place=FilterPlace.ERROR)
    limit = stability_limit(plant, settings, RATE)
    for factor, stable in ((0.99, False), (1.01, True)):
        model = AxisModel.trial(factor * limit * payload_mass(plant))
        assert (admittance_loop(plant, settings, model, RATE).growth < 0.0) is stable


def test_a_loop_that_no_mass_holds_has_no_limit(plant):
    """Gain beyond what the leg loop itself stands with the filter."""
    settings = LegSettings(200.0, place=FilterPlace.ERROR)
    assert stability_limit(plant, settings, RATE) == float("inf")


def test_a_slow_sensor_acts_as_the_corner_that_it_has(plant):
    """An effect and the number that it stands for give the same growth."""
    slow = plant.extended(SensorLag(target="sensor", slowness=1.0))
    corner = plant.parameters.number("sensor.corner")
    same = plant.with_values({"sensor.corner": 0.5 * corner})
    model = AxisModel.trial(0.3 * payload_mass(plant))
    growths = [admittance_loop(p, LegSettings(20.9), model, RATE).growth for p in (slow, same)]
    assert growths[0] == pytest.approx(growths[1], rel=1e-12)
